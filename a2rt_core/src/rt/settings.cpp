#include "a2rt/rt/settings.h"

namespace a2rt::rt {

UnitSettings read_unit_settings(const config::Section& section, std::int64_t default_leaf,
                                std::int64_t most_leaf) {
  UnitSettings s;
  const config::Section tree = section.table("tree");
  s.tree.branching = static_cast<unsigned>(
      tree.integer("branching", 6, 2, bvh::kMaxWidth, "children", "Widest node of the tree"));
  s.tree.max_leaf = static_cast<unsigned>(tree.integer("max_leaf", default_leaf, 1, most_leaf,
                                                       "primitives", "Largest leaf of the tree"));
  const config::Section layout = section.table("layout");
  s.layout.region_alignment = static_cast<std::uint32_t>(layout.integer(
      "region_alignment", 128, 1, 1 << 20, "bytes", "Structures start at multiples of this"));
  s.layout.sibling_alignment = static_cast<std::uint32_t>(
      layout.integer("sibling_alignment", 1, 1, 4096, "bytes",
                     "The children of a node start at multiples of this; 1 packs them"));
  s.layout.instance_bytes = static_cast<std::uint32_t>(
      layout.integer("instance_bytes", 64, 48, 4096, "bytes", "Record of one instance"));
  s.layout.id_bytes = static_cast<std::uint32_t>(
      layout.integer("id_bytes", 8, 4, 64, "bytes", "Geometry and primitive id of one primitive"));
  const config::Section traversal = section.table("traversal");
  s.traversal.front_to_back =
      traversal.boolean("front_to_back", true, "Visit the nearest child first, not slot order");
  s.traversal.retest_on_pop = traversal.boolean(
      "retest_on_pop", true, "Compare a popped entry with the closest hit found meanwhile");
  s.traversal.leaves_at_once = traversal.boolean(
      "leaves_at_once", false, "Intersect hit leaves in slot order before any inner child");
  s.traversal.far_first =
      traversal.boolean("far_first", false, "Pop the farthest of the waiting siblings first");
  return s;
}

void adopt_accounting(const config::Section& section, UnitSettings& settings,
                      Accounting default_accounting) {
  static constexpr const char* kNames[] = {"records", "published", "corrected"};
  const std::string name = section.table("layout").choice(
      "accounting", kNames[static_cast<std::size_t>(default_accounting)],
      {kNames[0], kNames[1], kNames[2]},
      "Memory accesses: the records read, as AQB8's public code charges them, or that without its "
      "slips");
  settings.layout.accounting = name == kNames[0]   ? Accounting::kRecords
                               : name == kNames[1] ? Accounting::kPublished
                                                   : Accounting::kCorrected;
  if (settings.layout.accounting == Accounting::kRecords) {
    return;
  }
  settings.traversal.leaves_at_once = true;
  settings.traversal.far_first = true;
  settings.traversal.retest_on_pop = false;
}

}  // namespace a2rt::rt
