// The list of effects: kinds of light transport and features that cost rays, stages or hardware.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace a2rt::effects {

struct Effect {
  std::string name;
  std::uint32_t bit = 0;            // kEffect* of glsl/shared.h
  std::string sentence;             // what it shows
  std::string rays;                 // what it traces, in words; empty: no rays of its own
  std::vector<std::string> stages;  // shader stages that carry it
  std::string part;                 // simulator part that it alone needs; empty: none
};

// All effects, in the order they are listed.
const std::vector<Effect>& all();
// Throws UserError naming the known effects if there is none of that name.
const Effect& by_name(const std::string& name);

}  // namespace a2rt::effects
