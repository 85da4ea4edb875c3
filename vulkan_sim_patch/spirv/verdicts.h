// Looks up what the modelled RT unit decided for a ray and bends the trace instruction to it.
#pragma once

#include "spirv/record_writer.h"

namespace a2rt::spirv {

struct RayArguments {
  Id mask = 0;  // as uint
  Id tmin = 0;  // float
  Id tmax = 0;
  Id overridden = 0;  // 1 if a verdict was applied, else 0
};

// Arguments to trace with instead of `program`: those of the VerdictEntry of this launch id and
// ordinal, or the program's own if there is none.
RayArguments apply_verdict(CodeBuilder& code, const RecordWriter& writer, const RecordSite& site,
                           const RayArguments& program);

}  // namespace a2rt::spirv
