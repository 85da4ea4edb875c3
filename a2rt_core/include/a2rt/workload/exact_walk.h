// The driver's traversal, operation for operation, over the driver's own nodes.
//
// It is the oracle of the capture: for every ray it must find what the driver found, t and ids bit
// for bit. It also tells what the driver found where no shader left a record, and which candidates
// a ray query passed over.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt {

// What one walk did.
struct WalkResult {
  Hit hit;  // state kHit or kMiss
  std::uint32_t box_tests = 0;
  std::uint32_t triangle_tests = 0;
  std::uint32_t deepest_stack = 0;
  // Candidates the walk met, in order, with the verdicts it went by. Only filled if asked for.
  std::vector<Candidate> met;
  // Verdicts that the walk did not meet where they were recorded; > 0 means that the walk and the
  // driver took different ways.
  std::uint32_t unused_verdicts = 0;
  std::uint32_t disagreements = 0;  // reports the driver accepted and the walk not, or vice versa
  bool stack_overflow = false;  // deeper than the driver's stack: the driver itself is wrong here
};

class ExactWalk {
 public:
  // Checks the layout of all trees (see driver_layout.h). `workload` must outlive the walk.
  explicit ExactWalk(const Workload& workload);

  // Empty, or why rays of this TLAS cannot be walked: "blas 3: leaf 7: coordinates differ ...".
  const std::string& problem(std::uint32_t tlas) const { return problems_.at(tlas); }

  // Walks one ray whose TLAS has no problem. `candidates` are its verdicts in the driver's order. A
  // non-opaque candidate without verdict is accepted (its any-hit shader is null), but ignored if
  // the ray is a query. Thread-safe.
  WalkResult walk(const Ray& ray, std::span<const Candidate> candidates,
                  bool keep_met = false) const;

 private:
  const Workload& workload_;
  std::vector<std::string> problems_;
};

}  // namespace a2rt
