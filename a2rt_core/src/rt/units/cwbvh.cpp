// Compressed wide BVH: 8-bit boxes per node, rebuilt in FP32 before the test (Ylitie, Karras,
// Laine, HPG 2017; the A2RT paper's reference [10]).
#include "a2rt/bvh/layout_pow2.h"
#include "a2rt/rt/box_unit.h"
#include "a2rt/rt/tree_unit.h"

namespace a2rt::rt {
namespace {

class Cwbvh : public BoxUnit {
 public:
  explicit Cwbvh(const config::Section& section)
      : BoxUnit({"cwbvh", "Compressed wide BVH", "Ylitie, Karras, Laine, HPG 2017, section 3",
                 Promise::kConservative, BoxTesters::kCompressed},
                read_unit_settings(section, bvh::kCwbvhMostLeaf, bvh::kCwbvhMostLeaf)) {}

  BoxTree encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                 StructureStats& stats) const {
    BoxTree result;
    stats.encode_seconds += seconds_of([&] {
      std::vector<std::byte> bytes = bvh::encode_cwbvh(tree, name);
      const std::uint32_t node_bytes = bvh::cwbvh_node_bytes(tree.width);
      result = BoxTree::mirror(tree, bvh::dequantized_boxes(tree, false, name));
      for (std::uint32_t n = 0; n < result.node_count(); ++n) {
        BoxNode& node = result.mutable_node(n);
        node.fetch_offset = std::uint64_t{n} * node_bytes;
        node.fetch_bytes = node_bytes;
        node.dequantized = true;
      }
      stats.node_bytes += bytes.size();
      const Address base = space.reserve(name + " nodes", Bytes{bytes.size()});
      result.set_memory(std::move(bytes), base);
    });
    return result;
  }
};

const RegisterUnit kRegistered("cwbvh", [](const config::Section& section) {
  return std::make_unique<TreeUnit<Cwbvh>>(Cwbvh(section));
});

}  // namespace
}  // namespace a2rt::rt
