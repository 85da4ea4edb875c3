// Which functions an entry point reaches and what they do with rays.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "a2rt/capture/records.h"
#include "spirv/module.h"

namespace a2rt::spirv {

// What one function contains, or what a set of functions contains together.
struct RayFeatures {
  bool traces = false;  // OpTraceRayKHR
  bool query_initializes = false;
  bool query_uses = false;  // any OpRayQuery*
  bool executes_callable = false;
  bool reports_intersection = false;
  bool ignores_intersection = false;
  bool terminates_ray = false;
  bool writes_state = false;   // stores beyond its own variables
  bool writes_memory = false;  // the same, but outputs are no memory
  bool discards = false;       // may end an invocation, or demote it to a helper
  bool is_ordered = false;     // interlocks, or opcodes this build does not know

  void include(const RayFeatures& other);
};

// An OpEntryPoint as written.
struct EntryDeclaration {
  const Instruction* instruction = nullptr;
  std::uint32_t model = 0;
  Id function = 0;
  std::string name;
  std::vector<Id> interface;
};

std::vector<EntryDeclaration> entry_declarations(const Module& module);
capture::Stage stage_of(std::uint32_t execution_model);
bool is_ray_tracing_stage(std::uint32_t execution_model);

class CallGraph {
 public:
  explicit CallGraph(const Module& module);

  // Functions reached from `root`, with it, in module order. Tolerates recursion.
  std::set<std::size_t> reached(Id root) const;
  const RayFeatures& features(std::size_t function) const { return nodes_[function].features; }
  RayFeatures features(const std::set<std::size_t>& functions) const;
  // Calling `function` may flush the counters: it or a callee traces, reports or calls out.
  bool may_flush(Id function) const;
  // All calls of `function`, as instructions.
  const std::vector<const Instruction*>& calls_of(Id function) const;

 private:
  struct Node {
    std::vector<std::size_t> callees;
    RayFeatures features;
    bool may_flush = false;
  };
  void scan(const Module& module, const Function& function, Node& node);
  void spread_flushes();

  std::unordered_map<Id, std::size_t> index_;
  std::vector<Node> nodes_;
  std::unordered_map<Id, std::vector<const Instruction*>> calls_;
};

}  // namespace a2rt::spirv
