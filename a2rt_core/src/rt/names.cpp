#include "a2rt/rt/names.h"

#include <array>
#include <cstddef>

namespace a2rt {

const char* name_of(EventKind kind) {
  static constexpr std::array<const char*, static_cast<std::size_t>(EventKind::kCount)> kNames = {
      "fetch",        "box_test",    "qbox_test",  "triangle_test", "ray_setup", "quantize_ray",
      "anchor_test",  "update",      "dequantize", "transform",     "push",      "pop",
      "context_push", "context_pop", "any_hit",    "intersection",  "escape"};
  return kNames.at(static_cast<std::size_t>(kind));
}

const char* name_of(Traffic traffic) {
  static constexpr std::array<const char*, static_cast<std::size_t>(Traffic::kCount)> kNames = {
      "none", "node",     "group_node", "sub_node", "anchor",          "triangle",
      "aabb", "instance", "stack",      "shader",   "primitive_index", "result"};
  return kNames.at(static_cast<std::size_t>(traffic));
}

const char* name_of(Promise promise) {
  switch (promise) {
    case Promise::kExact:
      return "exact";
    case Promise::kConservative:
      return "conservative";
    case Promise::kMayMiss:
      return "may_miss";
  }
  return "unknown";
}

}  // namespace a2rt
