// The FP32 RT core: every box accurate, 56 bytes a node (A2RT paper, sections II.B and V.C.2).
#include "a2rt/bvh/layout_fp32.h"
#include "a2rt/rt/box_unit.h"
#include "a2rt/rt/tree_unit.h"

namespace a2rt::rt {
namespace {

class Baseline : public BoxUnit {
 public:
  explicit Baseline(const config::Section& section)
      : BoxUnit({"baseline", "FP32 RT core", "A2RT paper, section V.A (56-byte nodes)",
                 Promise::kExact, BoxTesters::kFp32},
                read_unit_settings(section)),
        node_bytes_(static_cast<std::uint32_t>(section.table("layout").integer(
            "node_bytes", 56, bvh::kFp32RecordLeast, 4096, "bytes", "Record of one box"))) {
    adopt_accounting(section, settings_);
    settings_.layout.mesh_order = settings_.layout.accounting == Accounting::kPublished;
  }

  BoxTree encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                 StructureStats& stats) const {
    BoxTree result;
    stats.encode_seconds += seconds_of([&] {
      bvh::Fp32Layout layout =
          bvh::encode_fp32(tree, node_bytes_, settings_.layout.sibling_alignment, name);
      result = BoxTree::mirror(tree, {});
      // The public code's node holds its children's boxes; here only its size and place matter.
      const bool wide = settings_.layout.accounting != Accounting::kRecords;
      for (std::uint32_t n = 0; n < result.node_count(); ++n) {
        BoxNode& node = result.mutable_node(n);
        node.fetch_offset =
            wide ? n * kPublishedBaselineNodeBytes : layout.offset[node.first_record];
        node.fetch_bytes = wide ? kPublishedBaselineNodeBytes : node.count * node_bytes_;
      }
      const std::uint64_t bytes =
          wide ? result.node_count() * kPublishedBaselineNodeBytes : layout.bytes.size();
      stats.node_bytes += bytes;
      const Address base = space.reserve(name + " nodes", Bytes{bytes});
      result.set_memory(std::move(layout.bytes), base);
    });
    return result;
  }

 private:
  std::uint32_t node_bytes_;
};

const RegisterUnit kRegistered("baseline", [](const config::Section& section) {
  return std::make_unique<TreeUnit<Baseline>>(Baseline(section));
});

}  // namespace
}  // namespace a2rt::rt
