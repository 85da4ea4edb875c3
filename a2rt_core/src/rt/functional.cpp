#include "a2rt/rt/functional.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

#include "a2rt/workload/reference.h"

namespace a2rt::rt {
namespace {

constexpr std::uint64_t kChunk = 4096;

// What one thread gathers.
struct Share {
  EventTotals totals;
  Audit audit;
  std::uint64_t audited = 0;
};

class Run {
 public:
  Run(const RtUnit& unit, const Workload& workload, const FunctionalOptions& options)
      : unit_(unit), workload_(workload), options_(options) {
    result_.hits.resize(workload.rays.size());
  }

  FunctionalResult go() {
    const auto start = std::chrono::steady_clock::now();
    const unsigned threads = std::max(1U, options_.threads);
    std::vector<Share> shares(threads);
    {
      std::vector<std::jthread> workers;
      for (unsigned t = 1; t < threads; ++t) {
        workers.emplace_back([this, &shares, t] { work(shares[t]); });
      }
      work(shares[0]);
    }
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    for (const Share& share : shares) {
      result_.totals.add(share.totals);
      add_audit(result_.audit, share.audit);
      result_.audited_rays += share.audited;
    }
    result_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::move(result_);
  }

 private:
  void work(Share& share) try {
    const std::uint64_t n = workload_.rays.size();
    EventValues events([&share](const Event& event) { share.totals.add(event); });
    for (std::uint64_t first = next_.fetch_add(kChunk); first < n;
         first = next_.fetch_add(kChunk)) {
      const std::uint64_t end = std::min(n, first + kChunk);
      for (std::uint64_t i = first; i < end; ++i) {
        trace(i, share, events);
      }
      report(end - first);
    }
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    failure_ = std::current_exception();
    next_ = workload_.rays.size();
  }

  void trace(std::uint64_t i, Share& share, EventReceiver& events) {
    const RayInput input{&workload_.rays[i], candidates_of(workload_, i)};
    if (options_.events) {
      result_.hits[i] = unit_.trace(input, events);
    } else {
      result_.hits[i] = unit_.trace(input);
    }
    if (audited(i)) {
      unit_.trace(input, share.audit);
      ++share.audited;
    }
  }

  // Ray i is audited if it is the first of its stretch of n / audit_rays rays.
  bool audited(std::uint64_t i) const {
    const std::uint64_t n = workload_.rays.size(), wanted = std::min(options_.audit_rays, n);
    return wanted > 0 && (i == 0 || i * wanted / n != (i - 1) * wanted / n);
  }

  void report(std::uint64_t rays) {
    const std::uint64_t done = done_.fetch_add(rays) + rays;
    if (options_.progress) {
      const std::scoped_lock lock(mutex_);
      options_.progress(static_cast<double>(done) / static_cast<double>(workload_.rays.size()));
    }
  }

  const RtUnit& unit_;
  const Workload& workload_;
  const FunctionalOptions& options_;
  FunctionalResult result_;
  std::atomic<std::uint64_t> next_ = 0, done_ = 0;
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

void EventTotals::add(const Event& event) {
  const bool ordinal = event.kind == EventKind::kAnyHit;
  events[static_cast<std::size_t>(event.kind)] += ordinal ? 1U : event.count;
  if (event.kind == EventKind::kFetch) {
    TrafficTotal& t = traffic[static_cast<std::size_t>(event.traffic)];
    ++t.accesses;
    t.bytes += event.bytes;
  }
}

void EventTotals::add(const EventTotals& other) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    events[i] += other.events[i];
  }
  for (std::size_t i = 0; i < traffic.size(); ++i) {
    traffic[i].accesses += other.traffic[i].accesses;
    traffic[i].bytes += other.traffic[i].bytes;
  }
}

void add_audit(Audit& sum, const Audit& other) {
  sum.box_tests += other.box_tests;
  sum.qbox_tests += other.qbox_tests;
  sum.decided += other.decided;
  sum.exact_hits += other.exact_hits;
  sum.redundant_hits += other.redundant_hits;
  sum.missed_hits += other.missed_hits;
  sum.fp32_exact_hits += other.fp32_exact_hits;
  sum.fp32_redundant_hits += other.fp32_redundant_hits;
  sum.fp32_missed_hits += other.fp32_missed_hits;
  sum.escapes += other.escapes;
  sum.triangle_tests += other.triangle_tests;
  for (const auto& [mechanism, count] : other.missed_by_mechanism) {
    sum.missed_by_mechanism[mechanism] += count;
  }
}

FunctionalResult run_functional(const RtUnit& unit, const Workload& workload,
                                const FunctionalOptions& options) {
  return Run(unit, workload, options).go();
}

}  // namespace a2rt::rt
