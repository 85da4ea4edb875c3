#include "a2rt/rt/result_json.h"

#include <nlohmann/json.hpp>

#include "a2rt/rt/names.h"

namespace a2rt::rt {

using Json = nlohmann::ordered_json;

Json workload_json(const Workload& workload, const std::string& file) {
  std::uint64_t triangles = 0, aabbs = 0, instances = 0, primary = 0, hits = 0;
  for (const Blas& blas : workload.blas) {
    triangles += blas.triangles.size();
    aabbs += blas.aabbs.size();
  }
  for (const Tlas& tlas : workload.tlas) {
    instances += tlas.instances.size();
  }
  for (const Ray& ray : workload.rays) {
    primary += ray.parent == kNone ? 1U : 0U;
  }
  for (const Hit& hit : workload.driver_hits) {
    hits += hit.state == HitState::kHit || hit.state == HitState::kHitInferred ? 1U : 0U;
  }
  std::uint32_t width = 0, height = 0, frames = 0;
  for (const Dispatch& d : workload.dispatches) {
    width = std::max(width, d.width);
    height = std::max(height, d.height);
    frames = std::max(frames, d.frame + 1);
  }
  return {{"file", file},
          {"scene", workload.provenance.scene},
          {"workload", workload.provenance.workload},
          {"rays", workload.rays.size()},
          {"primary_rays", primary},
          {"hits", hits},
          {"triangles", triangles},
          {"aabbs", aabbs},
          {"instances", instances},
          {"width", width},
          {"height", height},
          {"frames", frames}};
}

Json unit_json(const UnitInfo& info) {
  return {{"name", info.name},
          {"title", info.title},
          {"source", info.source},
          {"promise", name_of(info.promise)}};
}

Json config_json(const config::Section& section) {
  Json all = Json::object();
  for (const config::ParameterDoc& p : section.describe()) {
    // TOML's booleans, numbers and quoted strings are JSON's; anything else stays text.
    Json value = Json::parse(p.value, nullptr, false);
    all[p.key] = value.is_discarded() ? Json(p.value) : value;
  }
  return all;
}

Json structure_json(const StructureStats& s) {
  return {{"build_seconds", s.build_seconds},
          {"classify_seconds", s.classify_seconds},
          {"encode_seconds", s.encode_seconds},
          {"inner_nodes", s.inner_nodes},
          {"leaf_nodes", s.leaf_nodes},
          {"group_nodes", s.group_nodes},
          {"sub_nodes", s.sub_nodes},
          {"node_bytes", s.node_bytes},
          {"group_bytes", s.group_bytes},
          {"sub_bytes", s.sub_bytes},
          {"triangle_bytes", s.triangle_bytes},
          {"box_bytes", s.box_bytes},
          {"depth", s.depth},
          {"sah_cost", s.sah_cost}};
}

Json events_json(const EventTotals& totals) {
  Json all = Json::object();
  for (std::size_t k = 0; k < totals.events.size(); ++k) {
    all[name_of(static_cast<EventKind>(k))] = totals.events[k];
  }
  return all;
}

Json traffic_json(const EventTotals& totals) {
  Json all = Json::object();
  for (std::size_t k = 1; k < totals.traffic.size(); ++k) {
    const TrafficTotal& t = totals.traffic[k];
    if (t.accesses > 0) {
      all[name_of(static_cast<Traffic>(k))] = {{"accesses", t.accesses}, {"bytes", t.bytes}};
    }
  }
  return all;
}

Json accuracy_json(const FunctionalResult& result, std::uint64_t lost) {
  const Audit& a = result.audit;
  Json by_mechanism = Json::object();
  for (const auto& [mechanism, count] : a.missed_by_mechanism) {
    by_mechanism[mechanism] = count;
  }
  return {{"audited_rays", result.audited_rays},
          {"box_tests", a.box_tests},
          {"qbox_tests", a.qbox_tests},
          {"triangle_tests", a.triangle_tests},
          {"decided", a.decided},
          {"exact_hits", a.exact_hits},
          {"redundant_hits", a.redundant_hits},
          {"missed_hits", a.missed_hits},
          {"lost_closest_hits", lost},
          {"escapes", a.escapes},
          {"by_mechanism", by_mechanism}};
}

}  // namespace a2rt::rt
