// Processor time of the calling thread: what steps of a build or a benchmark cost, whatever else
// the machine is doing.
#pragma once

#include <time.h>

namespace a2rt {

inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace a2rt
