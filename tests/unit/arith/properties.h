// The properties every stage of the arithmetic promises, each as one function over seeded cases.
// Used by the property tests (which demand that they hold) and by the mutation check (which
// demands that they break when the code is broken).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/arith/precision.h"

namespace a2rt::arith::testing {

struct PropertyResult {
  std::uint64_t checks = 0;
  std::uint64_t failures = 0;
  std::string first;  // description of the first failing case
};

struct Property {
  std::string name;  // a claim
  // Checks `cases` seeded cases; stops at the first failure if `stop_early`.
  PropertyResult (*check)(std::uint64_t seed, std::uint64_t cases, bool stop_early);
};

const std::vector<Property>& all_properties();

// Precisions whose guarantee is claimed: wide and guard, several widths, formats and columns.
const std::vector<A2rtPrecision>& conservative_precisions();
std::string name_of(const A2rtPrecision& precision);

}  // namespace a2rt::arith::testing
