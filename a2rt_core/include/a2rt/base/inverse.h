// Inverse of an affine map.
#pragma once

#include "a2rt/base/vec.h"

namespace a2rt {

// By cofactors in FP64, each entry rounded to FP32 once. A singular map gives infinities or NaN.
Affine inverse(const Affine& map);

}  // namespace a2rt
