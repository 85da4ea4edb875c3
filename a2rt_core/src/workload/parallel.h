// Independent items on several threads, in batches.
#pragma once

#include <cstdint>
#include <functional>

namespace a2rt {

struct ParallelOptions {
  std::uint32_t threads = 0;             // 0: as many as the machine has
  std::function<void(double)> progress;  // called from the calling thread with the share begun
};

// Calls body(first, last) for ranges that cover [0, count) once. An exception of the body is
// rethrown here after all threads have stopped.
void parallel_batches(std::uint64_t count, const ParallelOptions& options,
                      const std::function<void(std::uint64_t first, std::uint64_t last)>& body);

}  // namespace a2rt
