// The cases, by group; hard_case.cpp puts them in order.
#pragma once

#include <vector>

#include "a2rt/hard/hard_case.h"

namespace a2rt::hard {

std::vector<HardCase> direction_cases();
std::vector<HardCase> extent_cases();
std::vector<HardCase> origin_cases();
std::vector<HardCase> interval_cases();
std::vector<HardCase> scene_cases();

}  // namespace a2rt::hard
