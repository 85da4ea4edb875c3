// The table [precision] of an A2RT unit's configuration: the knobs of the accuracy price list.
#pragma once

#include <string>

#include "a2rt/arith/precision.h"

namespace a2rt {

namespace config {
class Section;
}

namespace rt {

// `origin`: default of the knob `origin`. Throws UserError naming the knob for impossible values.
arith::A2rtPrecision read_a2rt_precision(const config::Section& unit, arith::OriginDesign origin);

// That default, of the units `a2rt` and `a2rt-literal`.
arith::OriginDesign default_origin(const std::string& unit_name);

}  // namespace rt
}  // namespace a2rt
