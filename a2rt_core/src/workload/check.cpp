#include "a2rt/workload/check.h"

#include <algorithm>
#include <bit>
#include <mutex>

#include "a2rt/workload/exact_walk.h"
#include "a2rt/workload/reference.h"
#include "parallel.h"

namespace a2rt {
namespace {

// Empty if the walk found what the driver found.
std::string compare(const Hit& driver, const WalkResult& walk) {
  const Hit& found = walk.hit;
  if (walk.stack_overflow) {
    return "the driver's stack overflows";
  }
  if ((driver.state == HitState::kMiss) != (found.state == HitState::kMiss)) {
    return driver.state == HitState::kMiss ? "the driver missed" : "the walk missed";
  }
  if (driver.state != HitState::kMiss) {
    if (driver.instance != found.instance || driver.geometry != found.geometry ||
        driver.primitive != found.primitive) {
      return "another primitive";
    }
    if (std::bit_cast<std::uint32_t>(driver.t) != std::bit_cast<std::uint32_t>(found.t)) {
      return "another distance";
    }
    if (driver.kind != found.kind) {
      return "another hit kind";
    }
  }
  if (walk.disagreements > 0) {
    return "a report was accepted here and refused there";
  }
  return walk.unused_verdicts > 0 ? "a candidate was judged that the walk did not meet" : "";
}

class Checker {
 public:
  Checker(const Workload& workload, const CheckOptions& options)
      : workload_(workload), options_(options), walk_(workload) {}

  CheckReport run() {
    parallel_batches(workload_.rays.size(), {options_.threads, options_.progress},
                     [this](std::uint64_t first, std::uint64_t last) {
                       CheckReport own;
                       for (std::uint64_t i = first; i < last; ++i) {
                         ray(i, own);
                       }
                       merge(own);
                     });
    auto& differences = report_.differences;
    std::sort(differences.begin(), differences.end(),
              [](const auto& a, const auto& b) { return a.ray < b.ray; });
    differences.resize(std::min(differences.size(), options_.keep_differences));
    add_problems();
    return std::move(report_);
  }

 private:
  void ray(std::uint64_t index, CheckReport& report) const {
    const Ray& ray = workload_.rays[index];
    const Hit& driver = workload_.driver_hits[index];
    ++report.rays;
    if ((ray.flags & kRayOverridden) != 0) {
      ++report.overridden;
    } else if (driver.state == HitState::kUnknown) {
      ++report.unknown;
    } else if (!walk_.problem(ray.tlas).empty()) {
      ++report.unwalkable;
    } else {
      walked(index, driver, walk_.walk(ray, candidates_of(workload_, index)), report);
    }
  }

  void walked(std::uint64_t index, const Hit& driver, const WalkResult& walk,
              CheckReport& report) const {
    report.box_tests += walk.box_tests;
    report.triangle_tests += walk.triangle_tests;
    report.deepest_stack = std::max(report.deepest_stack, walk.deepest_stack);
    const std::string reason = compare(driver, walk);
    if (reason.empty()) {
      ++report.equal;
      return;
    }
    ++report.different;
    // Every batch keeps its first ones, so the first of all are among them.
    if (report.differences.size() < options_.keep_differences) {
      report.differences.push_back({index, driver, walk.hit, reason});
    }
  }

  void merge(const CheckReport& own) {
    const std::lock_guard lock(mutex_);
    report_.rays += own.rays;
    report_.equal += own.equal;
    report_.different += own.different;
    report_.overridden += own.overridden;
    report_.unknown += own.unknown;
    report_.unwalkable += own.unwalkable;
    report_.box_tests += own.box_tests;
    report_.triangle_tests += own.triangle_tests;
    report_.deepest_stack = std::max(report_.deepest_stack, own.deepest_stack);
    report_.differences.insert(report_.differences.end(), own.differences.begin(),
                               own.differences.end());
  }

  void add_problems() {
    for (std::uint32_t i = 0; i < workload_.tlas.size(); ++i) {
      if (!walk_.problem(i).empty()) {
        report_.problems.push_back(walk_.problem(i));
      }
    }
  }

  const Workload& workload_;
  const CheckOptions& options_;
  ExactWalk walk_;
  std::mutex mutex_;
  CheckReport report_;
};

}  // namespace

CheckReport check_workload(const Workload& workload, const CheckOptions& options) {
  return Checker(workload, options).run();
}

}  // namespace a2rt
