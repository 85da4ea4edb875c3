// Rebuilds the nesting of shader calls of one launch id from its flat list of records.
#pragma once

#include <cstdint>
#include <vector>

#include "import_manifest.h"
#include "import_records.h"

namespace a2rt::import {

// Rays that the records leave open; indices into Workload::rays.
struct OpenEnds {
  std::vector<std::uint32_t> unrecorded;      // no hit or miss shader was entered
  std::vector<std::uint32_t> judged_queries;  // queries with candidates that a shader judged
  std::uint64_t orphans = 0;
};

// Fed with the records of one launch id after the other. Appends to rays, driver_hits, candidates
// and segments.
//
// Who wrote a record is told by its stage and shader. A closest-hit or miss shader is known to
// begin (kHit, kMiss); any other begins with its first record. Every shader ends with kEnd, but an
// intersection shader whose any-hit shader terminated the ray does not, and without counters none
// does: then a shader has ended when one below it on the stack of calls goes on.
class LaunchParser {
 public:
  LaunchParser(const Manifest& manifest, const RawDispatch& dispatch, std::uint32_t dispatch_index,
               Workload& workload, OpenEnds& open_ends);

  void begin_launch() { stack_.clear(); }
  void record(const Record& record);
  void end_launch();

 private:
  // A running shader.
  struct Call {
    capture::Stage stage;
    std::uint32_t shader;
    std::uint32_t ray = kNone;    // the ray that called it
    std::uint32_t trace = kNone;  // its own trace that has not returned
    std::uint32_t query = kNone;  // its latest ray query
    bool judged = false;          // any-hit: its verdict was seen
  };
  struct Query {
    std::uint32_t ray = kNone;
    bool stepped = false;   // Proceed was called
    bool more = false;      // its latest call returned true
    bool accepted = false;  // a candidate was accepted since
    bool stopped = false;   // terminated by the program in a way that no verdict tells
  };
  struct PlacedCandidate {
    std::uint32_t ray;
    Candidate candidate;
  };

  Call* caller_of(const Record& record);
  Call* running(const Record& record);
  Call* candidate_shader(const Record& record);
  void enter(const Record& record);
  void begin_ray(Call& call, const Record& record);
  void end_call(const Record& record);
  void close_trace(Call& call);
  void pop();
  void add_candidate(const Call& call, const Record& record);
  void query_step(const Call& call, const Record& record);
  void query_verdict(const Call& call, const Record& record);
  void finish_query(const Query& query);
  void add_segment(const Record& record, std::size_t first_unit, std::uint32_t ray);
  std::uint32_t tlas_of(const Record& record) const;
  Query* query_of(const Call& call, const Record& record);

  const Manifest& manifest_;
  const RawDispatch& dispatch_;
  std::uint32_t dispatch_index_;
  Workload& workload_;
  OpenEnds& open_ends_;
  std::vector<Call> stack_;
  std::vector<Query> queries_;
  std::vector<PlacedCandidate> candidates_;
};

}  // namespace a2rt::import
