#include "a2rt/rt/a2rt_unit.h"

#include "a2rt/config/section.h"
#include "a2rt/rt/a2rt_precision.h"
#include "a2rt/rt/tree_unit.h"

namespace a2rt::rt {
namespace {

bvh::ClassifyConfig read_classification(const config::Section& unit) {
  const config::Section s = unit.table("classify");
  bvh::ClassifyConfig c;
  c.area_ratio = s.number("area_ratio", 0.02, 0, 1, "of the group's area", "S_t of equation 5");
  c.length_ratio =
      s.number("length_ratio", 0.02, 0, 1, "of the group's length", "L_t of equation 5");
  c.leaf = s.choice("leaf", "sub", {"sub", "group"}, "What a leaf that fails equation 5 becomes") ==
                   "sub"
               ? bvh::LeafPolicy::kSub
               : bvh::LeafPolicy::kGroup;
  return c;
}

}  // namespace

A2rtUnit::A2rtUnit(const config::Section& section, const std::string& name,
                   const std::string& title, arith::OriginDesign origin)
    : info_{name, title, "A2RT paper, sections III and IV", Promise::kConservative,
            BoxTesters::kA2rt},
      settings_(read_unit_settings(section)),
      classify_(read_classification(section)),
      quantizer_(read_a2rt_precision(section, origin)),
      tester_(quantizer_.precision()),
      group_bytes_(bvh::a2rt_group_bytes(quantizer_.precision())),
      sub_bytes_(bvh::a2rt_sub_bytes(quantizer_.precision())),
      refetch_group_(section.table("layout").boolean(
          "refetch_group", true,
          "A group popped from the stack is read again: its box and scales have left the unit. "
          "false: they wait beside the stack entry, at no cost")),
      literal_(quantizer_.precision().origin == arith::OriginDesign::kLiteral) {
  if (!precision().conservative()) {
    info_.promise = Promise::kMayMiss;
  }
}

A2rtTree A2rtUnit::encode(bvh::WideBvh& tree, const std::string& name, bvh::AddressSpace& space,
                          StructureStats& stats) const {
  bvh::Classification classes;
  stats.classify_seconds += seconds_of([&] { classes = bvh::classify(tree, classify_); });
  stats.group_nodes += classes.group_nodes;
  stats.sub_nodes += classes.sub_nodes;
  stats.group_bytes += classes.group_nodes * group_bytes_;
  stats.sub_bytes += classes.sub_nodes * sub_bytes_;
  A2rtTree result;
  stats.encode_seconds += seconds_of([&] {
    result = A2rtTree::encode(tree, classes, tester_, precision(),
                              settings_.layout.sibling_alignment, name);
    stats.node_bytes += result.bytes().size();
    const Address base = space.reserve(name + " nodes", Bytes{result.bytes().size()});
    result.set_base(base);
  });
  return result;
}

std::uint32_t A2rtUnit::test_escaped(const Tree& tree, const A2rtNode& node, std::uint32_t subs,
                                     const Space& space, const Context& context, float closest,
                                     Key* keys) const {
  arith::BoxBlock boxes;
  const arith::GroupFrame& frame = tree.frame(context.group);
  for (std::uint32_t s = node.group_count; s < node.count; ++s) {
    boxes.put(s, arith::dequantize_box(tester_.get(tree.planes(node), s), frame, precision()));
  }
  float entry[bvh::kMaxWidth];
  const std::uint32_t hit = subs & arith::slab_test_block(space.slab, boxes, closest, entry);
  for (std::uint32_t s = node.group_count; s < node.count; ++s) {
    keys[s] = entry[s];
  }
  return hit;
}

std::uint32_t A2rtUnit::test_groups_plain(const arith::BoxBlock& boxes, const Space& space,
                                          float closest, float* entry) const {
  std::uint32_t hit = 0;
  for (std::uint32_t s = 0; s < bvh::kMaxWidth; ++s) {
    const arith::SlabHit h = arith::slab_test_plain(space.slab, boxes.get(s), closest);
    entry[s] = h.t_entry;
    hit |= (h.hit ? 1U : 0U) << s;
  }
  return hit;
}

std::string A2rtUnit::miss_mechanism() const {
  if (precision().rounding == arith::QuantRounding::kNearest) {
    return "rounding to nearest";
  }
  return precision().origin == arith::OriginDesign::kLiteral
             ? "origin clamped to the group's range, or plain FP32 rounding of shift and scale"
             : "broken guarantee";
}

}  // namespace a2rt::rt
