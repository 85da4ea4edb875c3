// Consistency of a workload: every index in range, every count in agreement.
#pragma once

#include <string>

#include "a2rt/workload/workload.h"

namespace a2rt {

// What a workload holds; parts left out by a partial read are not checked against.
struct WorkloadParts {
  bool primitives = true;
  bool rays = true;
};

// Throws UserError "NAME: object[row]: what is wrong" for the first inconsistency. Floating-point
// values are not judged: NaN and infinity are legal input of a ray.
void validate(const Workload& workload, const std::string& name, const WorkloadParts& parts = {});

}  // namespace a2rt
