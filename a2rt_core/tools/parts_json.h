// The parts of a machine as JSON, for inspect and simulate.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "a2rt/workload/parts.h"

namespace a2rt::tools {

// [{"part", "called_for", "instantiated", "why"}], one entry per part. `why` says what is missing
// where a part is left out, and that nothing calls for it where it is instantiated nevertheless.
nlohmann::ordered_json parts_json(const Parts& called_for, const Parts& instantiated);

}  // namespace a2rt::tools
