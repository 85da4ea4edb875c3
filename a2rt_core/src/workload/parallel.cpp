#include "parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace a2rt {

void parallel_batches(std::uint64_t count, const ParallelOptions& options,
                      const std::function<void(std::uint64_t, std::uint64_t)>& body) {
  constexpr std::uint64_t kBatch = 4096;
  std::atomic<std::uint64_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&](bool reports) {
    try {
      for (std::uint64_t first = next.fetch_add(kBatch); first < count;
           first = next.fetch_add(kBatch)) {
        body(first, std::min(first + kBatch, count));
        if (reports && options.progress) {
          options.progress(static_cast<double>(std::min(first + kBatch, count)) /
                           static_cast<double>(count));
        }
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      error = error ? error : std::current_exception();
      next = count;
    }
  };
  const std::uint32_t hardware = std::max(1u, std::thread::hardware_concurrency());
  const std::uint64_t useful = (count + kBatch - 1) / kBatch;
  const std::uint64_t threads =
      std::min<std::uint64_t>(options.threads == 0 ? hardware : options.threads, useful);
  std::vector<std::thread> helpers;
  for (std::uint64_t i = 1; i < threads; ++i) {
    helpers.emplace_back(work, false);
  }
  work(true);
  for (auto& helper : helpers) {
    helper.join();
  }
  if (error) {
    std::rethrow_exception(error);
  }
}

}  // namespace a2rt
