// Geometry for the tests of the bvh room.
#pragma once

#include <cstdint>

#include "a2rt/bvh/wide_builder.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt::bvh {

inline Workload shape(synthetic::Shape kind, std::uint32_t primitives, std::uint64_t seed = 1) {
  synthetic::Config config;
  config.shape = kind;
  config.primitives = primitives;
  config.width = config.height = 1;
  config.secondary = 0;
  config.reference = false;
  config.seed = seed;
  return synthetic::make(config);
}

inline WideBvh build(synthetic::Shape kind, std::uint32_t primitives,
                     const WideBuildConfig& config = {}) {
  const Workload w = shape(kind, primitives);
  const WideBuilder builder(config);
  const Blas& blas = w.blas.at(0);
  return blas.procedural() ? builder.build(std::span<const Box>(blas.aabbs))
                           : builder.build(std::span<const Triangle>(blas.triangles));
}

}  // namespace a2rt::bvh
