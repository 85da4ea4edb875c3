// Shared refusals of the encoders: what a box must be before it may be quantized.
#pragma once

#include <string>

#include "a2rt/base/vec.h"

namespace a2rt::arith {

// Both throw UserError naming `what`, the axis and the planes.
void require_finite_box(const Box& box, const std::string& what);
void require_inside(const Box& box, const Box& outer, const std::string& what);

}  // namespace a2rt::arith
