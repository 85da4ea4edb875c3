#include "a2rt/timing/result_json.h"

#include <nlohmann/json.hpp>

namespace a2rt::timing {
namespace {

using Json = nlohmann::ordered_json;

double ratio(double part, double whole) { return whole > 0 ? part / whole : 0; }
double ratio(std::uint64_t part, std::uint64_t whole) {
  return ratio(static_cast<double>(part), static_cast<double>(whole));
}

std::uint64_t sum(const TrafficCounts& counts) {
  std::uint64_t total = 0;
  for (const std::uint64_t c : counts) {
    total += c;
  }
  return total;
}

template <class Reason, class Array>
Json reasons_json(const Array& cycles) {
  Json json;
  for (std::size_t r = 0; r < cycles.size(); ++r) {
    json[reason_name(static_cast<Reason>(r))] = cycles[r];
  }
  return json;
}

Json cache_json(const CacheCounts& c) {
  const std::uint64_t reads = sum(c.reads), hits = sum(c.hits), writes = sum(c.writes);
  Json by_kind;
  for (std::size_t k = 0; k < kTrafficKinds; ++k) {
    if (c.reads[k] + c.writes[k] > 0) {
      by_kind[traffic_name(static_cast<Traffic>(k))] = {
          {"accesses", c.reads[k] + c.writes[k]},
          {"hits", c.hits[k]},
          {"merges", c.merges[k]},
          {"misses", c.misses[k]},
          {"writes", c.writes[k]},
          {"bytes", (c.reads[k] + c.writes[k]) * kSectorBytes}};
    }
  }
  return {{"accesses", reads + writes},
          {"hits", hits},
          {"merges", sum(c.merges)},
          {"misses", sum(c.misses)},
          {"writes", writes},
          {"bytes", (reads + writes) * kSectorBytes},
          {"hit_rate", ratio(hits, reads)},
          {"bank_conflicts", c.bank_conflicts},
          {"mshr_full", c.mshr_full},
          {"evictions", c.evictions},
          {"written_back", c.written_back},
          {"by_kind", by_kind}};
}

Json dram_json(const SimulationResult& r) {
  Json by_kind;
  for (std::size_t k = 0; k < kTrafficKinds; ++k) {
    if (r.dram_reads[k] + r.dram_writes[k] > 0) {
      by_kind[traffic_name(static_cast<Traffic>(k))] = {
          {"reads", r.dram_reads[k]},
          {"writes", r.dram_writes[k]},
          {"bytes", (r.dram_reads[k] + r.dram_writes[k]) * kSectorBytes}};
    }
  }
  return {{"reads", r.dram.reads},
          {"writes", r.dram.writes},
          {"bytes", (r.dram.reads + r.dram.writes) * kSectorBytes},
          {"row_hits", r.dram.row_hits},
          {"row_misses", r.dram.row_misses},
          {"row_conflicts", r.dram.row_conflicts},
          {"activates", r.dram.activates},
          {"by_kind", by_kind}};
}

Json testers_json(const SimulationResult& r, const MachineConfig& config) {
  const double rt_cycles = static_cast<double>(r.cycles.value) *
                           static_cast<double>(config.rt.mhz) /
                           static_cast<double>(config.core_mhz);
  Json json;
  for (std::size_t t = 0; t < kTesters; ++t) {
    const TesterUse& use = r.testers[t];
    if (use.tests == 0) {
      continue;
    }
    json[tester_name(static_cast<Tester>(t))] = {
        {"count", use.count},
        {"latency", use.latency.value},
        {"interval", use.interval.value},
        {"tests", use.tests},
        {"busy_cycles", use.busy_cycles},
        {"queued_cycles", use.queued_cycles},
        {"utilisation", ratio(static_cast<double>(use.busy_cycles), rt_cycles * use.count)}};
  }
  return json;
}

Json utilisation_json(const SimulationResult& r, const MachineConfig& config) {
  const double cycles = static_cast<double>(r.cycles.value);
  const auto cycles_of = [&](std::uint64_t mhz) {
    return cycles * static_cast<double>(mhz) / static_cast<double>(config.core_mhz);
  };
  Json json;
  const Json testers = testers_json(r, config);
  for (auto tester = testers.begin(); tester != testers.end(); ++tester) {
    json[tester.key()] = tester.value().at("utilisation");
  }
  json["rt_port"] = ratio(static_cast<double>(r.rt.sectors_sent + r.rt.stores_sent),
                          cycles_of(config.rt.mhz) * config.sm.count * config.rt.port_sectors);
  json["lsu_port"] = ratio(static_cast<double>(r.sm.lsu_sectors),
                           cycles * config.sm.count * config.sm.lsu_sectors_per_cycle);
  json["l1_banks"] = ratio(static_cast<double>(sum(r.l1.reads) + sum(r.l1.writes)),
                           cycles * config.sm.count * config.l1.banks);
  json["l2_slices"] =
      ratio(static_cast<double>(sum(r.l2.reads) + sum(r.l2.writes)),
            cycles_of(config.l2.mhz) * config.l2.channels * config.l2.slices_per_channel);
  json["dram_bus"] = ratio(static_cast<double>(r.dram.busy_cycles),
                           cycles_of(config.dram.mhz) * config.l2.channels);
  json["schedulers"] = ratio(static_cast<double>(r.sm.instructions()),
                             cycles * config.sm.count * config.sm.schedulers);
  return json;
}

Json series_json(const SimulationResult& r) {
  Json json = Json::array();
  for (const Series& s : r.series) {
    json.push_back(
        {{"name", s.name}, {"unit", s.unit}, {"bin_cycles", s.bin_cycles}, {"means", s.means}});
  }
  return json;
}

Json histogram_json(const PowerHistogram& h) {
  Json bins = Json::array();
  for (std::size_t b = 0; b < h.bins().size(); ++b) {
    if (h.bins()[b] > 0) {
      bins.push_back({{"from", b == 0 ? 0 : std::uint64_t{1} << b},
                      {"to", std::uint64_t{1} << (b + 1)},
                      {"rays", h.bins()[b]}});
    }
  }
  return {{"rays", h.count()},
          {"mean", ratio(h.sum(), h.count())},
          {"largest", h.largest()},
          {"bins", bins}};
}

}  // namespace

const char* traffic_name(Traffic kind) {
  static constexpr const char* kNames[] = {
      "none", "node",     "group_node", "sub_node", "anchor",          "triangle",
      "aabb", "instance", "stack",      "shader",   "primitive_index", "result"};
  static_assert(std::size(kNames) == kTrafficKinds);
  return kNames[static_cast<std::size_t>(kind)];
}

const char* event_name(EventKind kind) {
  static constexpr const char* kNames[] = {
      "fetches",       "box_tests",    "qbox_tests",     "triangle_tests", "ray_setups",
      "quantize_rays", "anchor_tests", "updates",        "dequantizes",    "transforms",
      "pushes",        "pops",         "context_pushes", "context_pops",   "any_hits",
      "intersections", "escapes"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(EventKind::kCount));
  return kNames[static_cast<std::size_t>(kind)];
}

Json time_json(const SimulationResult& r, const MachineConfig& config) {
  const std::uint64_t rt_total = r.cycles.value * config.sm.count;
  const auto idle = r.rt_reasons[static_cast<std::size_t>(RtReason::kIdle)];
  Json dispatches = Json::array();
  for (const DispatchTime& d : r.dispatches) {
    dispatches.push_back({{"cycles", d.cycles.value}, {"rays", d.rays}, {"warps", d.warps}});
  }
  return {{"cycles", r.cycles.value},
          {"ms", r.milliseconds},
          {"rays", r.rays()},
          {"mrays_per_second", ratio(static_cast<double>(r.rays()), r.milliseconds * 1e3)},
          {"cycles_per_ray", ratio(r.cycles.value, r.rays())},
          {"rt_cycles", rt_total - idle},
          {"rt_cycles_of", rt_total},
          {"by_part",
           {{"sm_issue", r.sm.instructions()},
            {"warp_cycles", r.sm.warp_cycles},
            {"warp_cycles_in_rt", r.sm.rt_warp_cycles},
            {"rt_warp_cycles", r.rt.warp_cycles}}},
          {"stalls",
           {{"scheduler", reasons_json<SchedulerReason>(r.scheduler_reasons)},
            {"rt_unit", reasons_json<RtReason>(r.rt_reasons)},
            {"rt_lane", reasons_json<LaneReason>(r.rt.lane_cycles)}}},
          {"utilisation", utilisation_json(r, config)},
          {"testers", testers_json(r, config)},
          {"callbacks", {{"round_trips", r.rt.round_trips}, {"candidates", r.rt.candidates}}},
          {"instructions",
           {{"alu", r.sm.alu},
            {"sfu", r.sm.sfu},
            {"uniform", r.sm.uniform},
            {"loads", r.sm.loads},
            {"stores", r.sm.stores},
            {"traces", r.sm.traces},
            {"captured", r.shader_counts_captured}}},
          {"ray_cycles", histogram_json(r.ray_cycles)},
          {"series", series_json(r)},
          {"dispatches", dispatches}};
}

Json memory_json(const SimulationResult& r) {
  Json by_kind;
  for (std::size_t k = 0; k < kTrafficKinds; ++k) {
    if (r.rt.fetches[k] > 0) {
      by_kind[traffic_name(static_cast<Traffic>(k))] = {{"accesses", r.rt.fetches[k]},
                                                        {"bytes", r.rt.fetch_bytes[k]},
                                                        {"sectors", r.rt.sectors_wanted[k]}};
    }
  }
  return {{"by_kind", by_kind},
          {"rt_unit",
           {{"sectors_wanted", sum(r.rt.sectors_wanted)},
            {"sectors_sent", r.rt.sectors_sent},
            {"stores", r.rt.stores_sent},
            {"stack_spills", r.rt.stack_spills},
            {"stack_fills", r.rt.stack_fills},
            {"context_spills", r.rt.context_spills},
            {"context_fills", r.rt.context_fills},
            {"context_refetches", r.rt.context_refetches}}},
          {"levels", {{"l1", cache_json(r.l1)}, {"l2", cache_json(r.l2)}, {"dram", dram_json(r)}}}};
}

Json events_json(const SimulationResult& r) {
  Json json;
  for (std::size_t e = 0; e < r.rt.events.size(); ++e) {
    json[event_name(static_cast<EventKind>(e))] = r.rt.events[e];
  }
  return json;
}

Json fig2_json(const SimulationResult& r) {
  const auto event = [&](EventKind kind) { return r.rt.events[static_cast<std::size_t>(kind)]; };
  const auto tester = [&](Tester t) { return r.testers[static_cast<std::size_t>(t)]; };
  // A node's boxes are one instruction, as in Vulkan-Sim's trace of a traversal.
  const std::uint64_t tests = event(EventKind::kBoxTest) + event(EventKind::kQBoxTest) +
                              event(EventKind::kAnchorTest) + event(EventKind::kTriangleTest);
  std::uint64_t shader = 0;
  for (const std::uint64_t c : r.sm.lane_operations) {
    shader += c;
  }
  const auto unit_cycles = [&](Tester t) {
    return static_cast<double>(tester(t).tests) * static_cast<double>(tester(t).latency.value);
  };
  const double boxes = unit_cycles(Tester::kBox) + unit_cycles(Tester::kQBox) +
                       unit_cycles(Tester::kAnchor) + unit_cycles(Tester::kQuantizer) +
                       unit_cycles(Tester::kUpdate) + unit_cycles(Tester::kDequantize);
  const double triangles = unit_cycles(Tester::kTriangle);
  std::uint64_t bvh_held = 0, all_held = 0, bvh_reads = 0, all_reads = 0;
  for (std::size_t k = 0; k < kTrafficKinds; ++k) {
    const auto kind = static_cast<Traffic>(k);
    const bool bvh = kind != Traffic::kShader && kind != Traffic::kStack;
    all_held += r.l1_residence[k];
    all_reads += r.l1.reads[k] + r.l1.writes[k];
    bvh_held += bvh ? r.l1_residence[k] : 0;
    bvh_reads += bvh ? r.l1.reads[k] : 0;
  }
  return {{"intersection_instruction_share", ratio(tests, tests + shader)},
          {"execution_time_share", ratio(r.sm.rt_warp_cycles, r.sm.warp_cycles)},
          {"box_share_of_intersection_time", ratio(boxes, boxes + triangles)},
          {"bvh_share_of_l1_content", ratio(bvh_held, all_held)},
          {"bvh_share_of_l1_accesses", ratio(bvh_reads, all_reads)},
          {"how",
           {{"intersection_instruction_share",
             "node tests (one per node) and triangle tests, over those plus the shaders' own "
             "instructions, per lane"},
            {"execution_time_share",
             "warp-cycles between issuing a trace and its return, over all resident warp-cycles"},
            {"box_share_of_intersection_time",
             "tests x latency of the box testers, over those of box and triangle testers"},
            {"bvh_share_of_l1_content", "sector-cycles held in the L1s by BVH and primitive data"},
            {"bvh_share_of_l1_accesses", "sectors read from the L1s, over reads and writes"}}}};
}

}  // namespace a2rt::timing
