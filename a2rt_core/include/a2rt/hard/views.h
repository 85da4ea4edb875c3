// Pictures of the failures: what a unit that loses hits sees where brute force sees a solid body.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/hard/judge.h"

namespace a2rt::hard {

// One picture: a body, a grid of rays (one a pixel), and the unit that fails on it.
struct View {
  std::string key, column, title;
  std::string mechanism;  // what the picture is of, as blame() names it
  std::string what;
  Workload (*make)(std::uint32_t side);  // about side * side rays, a square; rows from the top
};
const std::vector<View>& views();

struct Picture {
  std::uint32_t side = 0;
  std::vector<std::uint8_t> shade;  // brute force's brightness, 1..255; 0: background
  // Per pixel: '.' as brute force, 'L' lost, 'F' farther hit; small letters: by another mechanism
  // than the view's.
  std::string kind;
  std::uint64_t hit_pixels = 0, lost = 0, farther = 0;
  std::map<std::string, std::uint64_t> lost_by_mechanism;  // pixels; sums to lost + farther
};
Picture draw(const View& view, std::uint32_t side);

}  // namespace a2rt::hard
