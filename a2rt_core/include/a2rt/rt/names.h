// Names of events and traffic in results and tables.
#pragma once

#include "a2rt/rt/event.h"
#include "a2rt/rt/unit.h"

namespace a2rt {

const char* name_of(EventKind kind);   // "fetch", "qbox_test", ...
const char* name_of(Traffic traffic);  // "group_node", ...
const char* name_of(Promise promise);  // "exact", "conservative", "may_miss"

}  // namespace a2rt
