// The conservative quantizer on four lanes (SSE2): the same operations in the same order as the
// scalar code of ray_quantizer.cpp, hence the same bits.
#pragma once

#include <cstdint>

#include "a2rt/arith/ray_quantizer.h"

namespace a2rt::arith {

struct VectorQuantizer {
  float min_origin, max_origin, offset;
  std::uint32_t dropped_bits;  // FP32 mantissa bits the direction format lacks
  int significand_bits;
  bool tables;  // fill the fields for the multiplier's correction tables

  enum class Result : std::uint8_t {
    kQuantized,
    kEscaped,
    kUnsupported  // a rate needs the scalar code's substitutes, or there are no vectors
  };
  Result enter(const QuantizerRay& ray, const GroupFrame& frame, float t_shift,
               GroupRay& out) const;
};

}  // namespace a2rt::arith
