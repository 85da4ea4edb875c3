// a2rt-core inspect: what a workload holds and which effects it calls for.
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "a2rt/capture/records.h"
#include "a2rt/workload/effects.h"
#include "a2rt/workload/file.h"
#include "command.h"
#include "parts_json.h"

namespace a2rt::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 8> kCounterNames = {
    "alu", "sfu", "uniform_load", "buffer_load", "buffer_store", "texture", "payload", "control"};
constexpr std::array<const char*, 9> kStageNames = {"raygen",      "intersection", "any_hit",
                                                    "closest_hit", "miss",         "callable",
                                                    "compute",     "fragment",     "other"};

const char* stage_name(std::uint32_t stage) {
  return stage < kStageNames.size() ? kStageNames[stage] : "other";
}

Json provenance(const Workload& w) {
  const Provenance& p = w.provenance;
  return {{"program", p.program},           {"driver", p.driver},
          {"command_line", p.command_line}, {"scene", p.scene},
          {"workload", p.workload},         {"refused", p.refused},
          {"tree_rebuilt", p.tree_rebuilt}};
}

Json geometry(const Workload& w) {
  std::uint64_t triangles = 0, aabbs = 0, geometries = 0, instances = 0, instanced = 0, nodes = 0;
  for (const Blas& b : w.blas) {
    triangles += b.triangles.size();
    aabbs += b.aabbs.size();
    geometries += b.geometries.size();
    nodes += b.driver_nodes.size();
  }
  for (const Tlas& t : w.tlas) {
    instances += t.instances.size();
    nodes += t.driver_nodes.size();
    for (const Instance& i : t.instances) {
      instanced += i.blas == kNone ? 0 : w.blas[i.blas].primitive_count();
    }
  }
  return {{"triangles", triangles},
          {"aabbs", aabbs},
          {"blas", w.blas.size()},
          {"geometries", geometries},
          {"tlas", w.tlas.size()},
          {"instances", instances},
          {"instanced_primitives", instanced},
          {"driver_node_bytes", nodes}};
}

// Rays by what they are for, as far as flags and place in the program tell.
const char* kind_of(const Ray& ray) {
  if ((ray.flags & kRayTerminateOnFirstHit) != 0) {
    return "occlusion";
  }
  return ray.ordinal == 0 ? "primary" : "secondary";
}

Json rays(const Workload& w) {
  std::map<std::string, std::uint64_t> kinds;
  std::uint64_t hits = 0, inferred = 0, unknown = 0, queries = 0, overridden = 0, deepest = 0;
  for (std::size_t i = 0; i < w.rays.size(); ++i) {
    const Ray& ray = w.rays[i];
    ++kinds[kind_of(ray)];
    const HitState state = w.driver_hits[i].state;
    hits += state == HitState::kHit || state == HitState::kHitInferred ? 1 : 0;
    inferred += state == HitState::kHitInferred ? 1 : 0;
    unknown += state == HitState::kUnknown ? 1 : 0;
    queries += (ray.flags & kRayQuery) != 0 ? 1 : 0;
    overridden += (ray.flags & kRayOverridden) != 0 ? 1U : 0U;
    deepest = std::max<std::uint64_t>(deepest, ray.ordinal + 1);
  }
  return {{"count", w.rays.size()},
          {"by_kind", kinds},
          {"hits", hits},
          {"inferred_hits", inferred},
          {"unknown", unknown},
          {"queries", queries},
          {"overridden", overridden},
          {"most_per_launch", deepest},
          {"candidates", w.candidates.size()}};
}

Json dispatches(const Workload& w) {
  Json all = Json::array();
  for (const Dispatch& d : w.dispatches) {
    all.push_back({{"frame", d.frame},
                   {"width", d.width},
                   {"height", d.height},
                   {"depth", d.depth},
                   {"rays", d.ray_count},
                   {"segments", d.segment_count}});
  }
  return all;
}

// Instruction mix per stage: sums of the eight counters over all segments.
Json instructions(const Workload& w) {
  std::map<std::uint32_t, std::array<std::uint64_t, 8>> sums;
  std::map<std::uint32_t, std::uint64_t> segments;
  for (const Segment& s : w.segments) {
    const std::uint32_t stage = w.shaders[s.shader].stage;
    ++segments[stage];
    auto& sum = sums[stage];
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += s.counts[i];
    }
  }
  Json all = Json::object();
  for (const auto& [stage, sum] : sums) {
    Json row{{"segments", segments[stage]}};
    for (std::size_t i = 0; i < sum.size(); ++i) {
      row[kCounterNames[i]] = sum[i];
    }
    all[stage_name(stage)] = row;
  }
  return all;
}

// Stages of the program's pipelines, with how often each ran: 0 for a stage built in vain.
Json stages(const Workload& w) {
  std::vector<std::uint64_t> ran(w.shaders.size(), 0);
  for (const Segment& s : w.segments) {
    ++ran[s.shader];
  }
  Json all = Json::array();
  for (std::size_t i = 0; i < w.shaders.size(); ++i) {
    all.push_back({{"stage", stage_name(w.shaders[i].stage)},
                   {"entry", w.shaders[i].entry},
                   {"segments", ran[i]}});
  }
  return all;
}

Json parts(const Workload& w) {
  const Parts called_for = parts_called_for(w);
  return parts_json(called_for, called_for);
}

Json effects(const Workload& w) {
  Json all = Json::array();
  for (const EffectUse& use : derive_effects(w).uses) {
    all.push_back({{"effect", use.name},
                   {"used", use.used},
                   {"rays", use.rays},
                   {"reason", use.reason},
                   {"stages", use.stages},
                   {"parts", use.parts}});
  }
  return all;
}

Json describe(const Workload& w, const std::string& file) {
  return {{"schema", 1},
          {"file", file},
          {"provenance", provenance(w)},
          {"geometry", geometry(w)},
          {"rays", rays(w)},
          {"dispatches", dispatches(w)},
          {"instructions", instructions(w)},
          {"stages", stages(w)},
          {"effects", effects(w)},
          {"parts", parts(w)}};
}

void print_numbers(const char* title, const Json& values) {
  std::printf("%s\n", title);
  for (const auto& [key, value] : values.items()) {
    if (value.is_object()) {
      for (const auto& [inner, number] : value.items()) {
        std::printf("  %-22s %s\n", inner.c_str(), number.dump().c_str());
      }
    } else {
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      if (!text.empty()) {
        std::printf("  %-22s %s\n", key.c_str(), text.c_str());
      }
    }
  }
}

void print_instructions(const Json& stages) {
  std::printf("instructions per segment\n  %-13s %10s", "stage", "segments");
  for (const char* name : kCounterNames) {
    std::printf(" %12s", name);
  }
  std::printf("\n");
  for (const auto& [stage, row] : stages.items()) {
    const auto segments = row["segments"].get<double>();
    std::printf("  %-13s %10.0f", stage.c_str(), segments);
    for (const char* name : kCounterNames) {
      std::printf(" %12.1f", row[name].get<double>() / segments);
    }
    std::printf("\n");
  }
}

void print_effects(const Json& all) {
  std::printf("effects\n  %-17s %-4s %10s  %-34s %s\n", "effect", "used", "rays", "parts",
              "called for by");
  for (const Json& use : all) {
    std::printf("  %-17s %-4s %10llu  %-34s %s\n", use["effect"].get<std::string>().c_str(),
                use["used"].get<bool>() ? "yes" : "-", use["rays"].get<unsigned long long>(),
                use["parts"].get<std::string>().c_str(), use["reason"].get<std::string>().c_str());
  }
}

void print_stages(const Json& all) {
  std::printf("stages of the pipelines\n  %-13s %10s\n", "stage", "segments");
  for (const Json& s : all) {
    std::printf("  %-13s %10llu\n", s["stage"].get<std::string>().c_str(),
                s["segments"].get<unsigned long long>());
  }
}

void print_parts(const Json& all) {
  std::printf("parts of the machine\n");
  for (const Json& p : all) {
    std::printf("  %-25s %-9s %s\n", p["part"].get<std::string>().c_str(),
                p["instantiated"].get<bool>() ? "used" : "left out",
                p["why"].get<std::string>().c_str());
  }
}

struct Arguments {
  std::string file;
  bool json = false;
};

int run(const Arguments& arguments) {
  const Workload workload = read_workload(arguments.file, {.driver_nodes = true});
  const Json all = describe(workload, arguments.file);
  if (arguments.json) {
    std::printf("%s\n", all.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    return 0;
  }
  print_numbers("provenance", all["provenance"]);
  print_numbers("geometry", all["geometry"]);
  print_numbers("rays", all["rays"]);
  std::printf("dispatches\n");
  for (const Json& d : all["dispatches"]) {
    std::printf("  frame %u: %u x %u x %u, %llu rays\n", d["frame"].get<unsigned>(),
                d["width"].get<unsigned>(), d["height"].get<unsigned>(), d["depth"].get<unsigned>(),
                d["rays"].get<unsigned long long>());
  }
  print_instructions(all["instructions"]);
  print_stages(all["stages"]);
  print_effects(all["effects"]);
  print_parts(all["parts"]);
  return 0;
}

const RegisterCommand kInspect("inspect", "Show what a workload file holds and calls for",
                               "  a2rt-core inspect ship.h5\n  a2rt-core inspect ship.h5 --json\n",
                               [](cli::Options& app) {
                                 auto arguments = std::make_shared<Arguments>();
                                 app.add("file", arguments->file, "workload file").required();
                                 app.flag("--json", arguments->json,
                                          "machine-readable, to standard output");
                                 return [arguments] { return run(*arguments); };
                               });

}  // namespace
}  // namespace a2rt::tools
