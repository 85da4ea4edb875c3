// Rewrites the body of one function: counters per block, records around ray instructions.
#pragma once

#include <cstdint>
#include <vector>

#include "spirv/call_graph.h"
#include "spirv/counters.h"
#include "spirv/hit_data.h"
#include "spirv/instrument.h"
#include "spirv/query_records.h"
#include "spirv/record_writer.h"
#include "spirv/weights.h"

namespace a2rt::spirv {

// What all passes over one module share.
struct Instrumentation {
  const InstrumentOptions& options;
  const CallGraph& calls;
  const RecordWriter& writer;
  const Counters& counters;
  const HitData& hits;
  const WeightTable& weights;
  QueryRecords& queries;

  bool keeps_ordinals() const { return options.rays || options.verdicts; }
  bool records_queries() const { return options.results || options.candidates; }
};

// Writes a kEnd record, if counters are on.
void put_end(CodeBuilder& code, const Instrumentation& shared);
// Writes the kAnyHit record of an any-hit shader that leaves, if candidates are on.
void put_any_hit(CodeBuilder& code, const Instrumentation& shared, capture::AnyHitVerdict verdict);

class FunctionPass {
 public:
  // `next_site` is the number of the function's first trace instruction.
  FunctionPass(const Instrumentation& shared, TypePool& types, std::uint32_t next_site)
      : shared_(shared), types_(types), next_site_(next_site) {}

  std::vector<Instruction> rewrite(const Function& function);

 private:
  void block(std::span<const Instruction> code);
  void instruction(const Instruction& original);
  void leave(std::span<const Instruction> tail);
  void trace(const Instruction& original);
  void call(const Instruction& original);
  void report(const Instruction& original);
  void segment();
  void emit_pending();
  void copy(const Instruction& original) { out_.push_back(original); }
  void append_code(CodeBuilder& code);

  const Instrumentation& shared_;
  TypePool& types_;
  std::uint32_t next_site_;
  Weights pending_;
  std::vector<Instruction> out_;
};

// True for OpTraceRayKHR and OpRayQueryInitializeKHR, the instructions that are numbered as sites.
bool is_trace_site(const Instruction& instruction);

}  // namespace a2rt::spirv
