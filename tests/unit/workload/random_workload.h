// Valid workloads with random content: any bits in floats, empty arrays, several of everything.
#pragma once

#include <cstdint>

#include "a2rt/workload/workload.h"

namespace a2rt::testing {

Workload random_workload(std::uint64_t seed);

// Equality of all content, floats by their bits.
bool same_bits(const Workload& a, const Workload& b);

}  // namespace a2rt::testing
