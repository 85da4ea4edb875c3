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
                 Promise::kConservative, BoxTesters::kCompressed},
                read_unit_settings(section)),
        node_bytes_(static_cast<std::uint32_t>(
            section.table("layout").integer("node_bytes", 56, bvh::kFp32RecordLeast, 4096, "bytes",
                                            "Record of one uncompressed box"))) {}

  BoxTree encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                 StructureStats& stats) const {
    BoxTree result;
    stats.encode_seconds += seconds_of([&] {
      bvh::check_boxes(tree, name);
      Clbvh::Places places = place(tree);
      std::vector<std::byte> bytes = pack(tree, name, places);
      result = BoxTree::mirror(tree, bvh::dequantized_boxes(tree, true, name));
      for (std::uint32_t n = 0; n < result.node_count(); ++n) {
        BoxNode& node = result.mutable_node(n);
        node.fetch_offset = places[n].offset;
        node.fetch_bytes = places[n].bytes;
        node.dequantized = places[n].multi_leaf;
      }
      stats.node_bytes += bytes.size();
      const Address base = space.reserve(name + " nodes", Bytes{bytes.size()});
      result.set_memory(std::move(bytes), base);
    });
    return result;
  }

 private:
  // Child block of one inner node: FP32 records of the children, or one multi-leaf node.
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
    bool multi_leaf = false;
  };
  using Places = std::vector<Place>;

  Places place(const bvh::WideBvh& tree) const {
    const std::uint64_t align = settings_.layout.sibling_alignment;
    Places places;
    std::uint64_t next = node_bytes_;
    for (std::uint32_t i = 0; i < tree.records.size(); ++i) {
      const bvh::BvhRecord& r = tree.records[i];
      if (r.leaf()) {
        continue;
      }
      next = (next + align - 1) / align * align;
      const bool multi = bvh::is_multi_leaf(tree, i);
      places.push_back(
          {next, multi ? bvh::clbvh_multi_leaf_bytes(r.count) : r.count * node_bytes_, multi});
      next += places.back().bytes;
    }
    return places;
  }

  // The root's record, then the child blocks. A record names its child block by byte offset; its id
  // byte is 0xfe for a leaf, 1 if the block is a multi-leaf node, else 0.
  std::vector<std::byte> pack(const bvh::WideBvh& tree, const std::string& name,
                              const Places& places) const {
    std::vector<std::byte> bytes;
    if (places.empty()) {
      return bytes;
    }
    const std::vector<std::uint32_t> number = bvh::number_inner_records(tree);
    bvh::ByteWriter out(bytes, places.back().offset + places.back().bytes);
    write_record(out, tree, 0, number, places);
    for (std::uint32_t i = 0; i < tree.records.size(); ++i) {
      const bvh::BvhRecord& r = tree.records[i];
      if (r.leaf()) {
        continue;
      }
      const Place& at = places[number[i]];
      out.pad_to(at.offset);
      if (at.multi_leaf) {
        out.raw(bvh::encode_multi_leaf(tree, i, name));
        continue;
      }
      for (std::uint32_t c = r.first; c < r.first + r.count; ++c) {
        write_record(out, tree, c, number, places);
      }
    }
    out.finish();
    return bytes;
  }

  void write_record(bvh::ByteWriter& out, const bvh::WideBvh& tree, std::uint32_t i,
                    const std::vector<std::uint32_t>& number, const Places& places) const {
    const std::size_t at = out.size();
    const bvh::BvhRecord& r = tree.records[i];
    out.box(r.box);
    if (r.leaf()) {
      out.u32(r.first);
      out.u32(r.first + r.count);
      out.u8(0xfe);
    } else {
      const Place& block = places[number[i]];
      out.u32(static_cast<std::uint32_t>(block.offset));
      out.u32(static_cast<std::uint32_t>(block.offset + block.bytes));
      out.u8(block.multi_leaf ? 1 : 0);
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
