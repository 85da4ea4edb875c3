// Compressed-leaf BVH: nodes whose children are all leaves hold 8-bit boxes, the rest stays FP32
// (Benthin, Wald, Woop, Afra, HPG 2018; the A2RT paper's reference [9]).
#include "a2rt/bvh/layout_fp32.h"
#include "a2rt/bvh/layout_pow2.h"
#include "a2rt/bvh/packing.h"
#include "a2rt/rt/box_unit.h"
#include "a2rt/rt/tree_unit.h"

namespace a2rt::rt {
namespace {

class Clbvh : public BoxUnit {
 public:
  explicit Clbvh(const config::Section& section)
      : BoxUnit({"clbvh", "Compressed-leaf BVH", "Benthin, Wald, Woop, Afra, HPG 2018",
                 Promise::kConservative},
                read_unit_settings(section)),
        node_bytes_(static_cast<std::uint32_t>(
            section.table("layout").integer("node_bytes", 56, bvh::kFp32RecordLeast, 4096, "bytes",
                                            "Record of one uncompressed box"))) {}

  BoxTree encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                 StructureStats& stats) const {
    BoxTree result;
    stats.encode_seconds += seconds_of([&] {
      bvh::check_boxes(tree, name);
      result = BoxTree::mirror(tree, bvh::dequantized_boxes(tree, true, name));
      std::vector<std::byte> bytes = pack(tree, name, result);
      stats.node_bytes += bytes.size();
      const Address base = space.reserve(name + " nodes", Bytes{bytes.size()});
      result.set_memory(std::move(bytes), base);
    });
    return result;
  }

 private:
  // Two kinds of child blocks in record order: FP32 records of the children, or one multi-leaf
  // node. FP32 records name the block of their children by byte offset; bit 0 of the id byte says
  // that it is a multi-leaf node.
  std::vector<std::byte> pack(const bvh::WideBvh& tree, const std::string& name,
                              BoxTree& mirror) const {
    std::vector<std::byte> bytes;
    if (mirror.node_count() == 0) {
      return bytes;
    }
    place(tree, mirror);
    const std::vector<std::uint32_t> number = bvh::number_inner_records(tree);
    bvh::ByteWriter out(bytes);
    write_record(out, tree, 0, number, mirror);
    for (std::uint32_t i = 0; i < tree.records.size(); ++i) {
      const bvh::BvhRecord& r = tree.records[i];
      if (r.leaf()) {
        continue;
      }
      out.pad_to(mirror.node(number[i]).fetch_offset);
      if (bvh::is_multi_leaf(tree, i)) {
        const std::vector<std::byte> block = bvh::encode_multi_leaf(tree, i, name);
        bytes.insert(bytes.end(), block.begin(), block.end());
        continue;
      }
      for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
        write_record(out, tree, c, number, mirror);
      }
    }
    return bytes;
  }

  void place(const bvh::WideBvh& tree, BoxTree& mirror) const {
    const std::uint64_t align = settings_.layout.sibling_alignment;
    std::uint64_t next = node_bytes_;
    std::uint32_t n = 0;
    for (std::uint32_t i = 0; i < tree.records.size(); ++i) {
      if (tree.records[i].leaf()) {
        continue;
      }
      BoxNode& node = mirror.mutable_node(n++);
      next = (next + align - 1) / align * align;
      node.dequantized = bvh::is_multi_leaf(tree, i);
      node.fetch_offset = next;
      node.fetch_bytes =
          node.dequantized ? bvh::clbvh_multi_leaf_bytes(node.count) : node.count * node_bytes_;
      next += node.fetch_bytes;
    }
  }

  void write_record(bvh::ByteWriter& out, const bvh::WideBvh& tree, std::uint32_t i,
                    const std::vector<std::uint32_t>& number, const BoxTree& mirror) const {
    const std::size_t at = out.size();
    const bvh::BvhRecord& r = tree.records[i];
    out.box(r.box);
    if (r.leaf()) {
      out.u32(r.first);
      out.u32(r.first + r.count);
      out.u8(0xfe);
    } else {
      const BoxNode& node = mirror.node(number[i]);
      out.u32(static_cast<std::uint32_t>(node.fetch_offset));
      out.u32(static_cast<std::uint32_t>(node.fetch_offset + node.fetch_bytes));
      out.u8(node.dequantized ? 1 : 0);
    }
    out.pad_to(at + node_bytes_);
  }

  std::uint32_t node_bytes_;
};

const RegisterUnit kRegistered("clbvh", [](const config::Section& section) {
  return std::make_unique<TreeUnit<Clbvh>>(Clbvh(section));
});

}  // namespace
}  // namespace a2rt::rt
