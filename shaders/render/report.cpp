#include "render/report.h"

#include <nlohmann/json.hpp>

namespace a2rt::render {
namespace {

using nlohmann::ordered_json;

std::string why_not(const effects::Call& call, const effects::Choice& choice,
                    const workloads::WorkloadConfig& workload) {
  if (choice.has(call.effect.bit)) {
    return "";
  }
  if (!call.supported) {
    return "workload " + workload.name + " does not show it";
  }
  return call.called_for_by.empty() ? "nothing in the scene calls for it"
                                    : "left out by the list of effects";
}

ordered_json effects_object(const std::vector<effects::Call>& calls, const effects::Choice& choice,
                            const workloads::WorkloadConfig& workload) {
  ordered_json all = ordered_json::object();
  for (const effects::Call& call : calls) {
    ordered_json e;
    e["needed"] = call.needed();
    e["built"] = choice.has(call.effect.bit);
    e["called_for_by"] = call.called_for_by;
    e["stages"] = call.effect.stages;
    e["rays"] = call.effect.rays;
    e["part"] = call.effect.part;
    e["shows"] = call.effect.sentence;
    const std::string reason = why_not(call, choice, workload);
    if (!reason.empty()) {
      e["left_out_because"] = reason;
    }
    all[call.effect.name] = e;
  }
  return all;
}

ordered_json scene_object(const scene::Scene& scene) {
  const scene::Counts c = scene::count(scene);
  const scene::Bounds b = scene::world_bounds(scene);
  return {{"name", scene.name},
          {"triangles", c.triangles},
          {"drawn_triangles", c.drawn_triangles},
          {"vertices", c.vertices},
          {"meshes", c.meshes},
          {"primitives", c.primitives},
          {"instances", c.instances},
          {"shapes", c.shapes},
          {"materials", scene.materials.size()},
          {"textures", scene.textures.size()},
          {"lights", scene.lights.size()},
          {"inactive_triangles", scene.inactive_triangles},
          {"lumibench", scene.lumibench},
          {"bounds", {{b.lo.x, b.lo.y, b.lo.z}, {b.hi.x, b.hi.y, b.hi.z}}},
          {"warnings", scene.warnings}};
}

}  // namespace

std::string effects_json(const std::vector<effects::Call>& calls, const effects::Choice& choice,
                         const workloads::WorkloadConfig& workload) {
  return effects_object(calls, choice, workload).dump(2) + "\n";
}

std::string stats_json(const ReportInput& in) {
  ordered_json j;
  j["scene"] = scene_object(in.scene);
  j["workload"] = {{"name", in.workload.name},
                   {"title", in.workload.title},
                   {"lumibench", in.workload.lumibench},
                   {"max_bounces", in.workload.max_bounces},
                   {"clamp_indirect", in.workload.clamp_indirect},
                   {"shadow_rays", in.workload.shadow_rays},
                   {"ao_rays", in.workload.ao_rays},
                   {"recursion", in.workload.recursion},
                   {"rays", in.workload.rays}};
  j["camera"] = {{"name", in.camera.name},
                 {"eye", {in.camera.eye.x, in.camera.eye.y, in.camera.eye.z}},
                 {"forward", {in.camera.forward.x, in.camera.forward.y, in.camera.forward.z}},
                 {"vertical_fov_radians", in.camera.vertical_fov}};
  j["picture"] = {{"width", in.settings.width},
                  {"height", in.settings.height},
                  {"samples", in.settings.samples},
                  {"frames", in.settings.frames},
                  {"seed", in.settings.seed}};
  j["effects"] = effects_object(in.calls, in.choice, in.workload);
  j["lacking"] = in.choice.lacking;
  j["pipeline"] = {{"stages", in.renderer.stage_files()},
                   {"structure_bytes", in.renderer.structure_bytes()}};
  const Timings& t = in.renderer.timings();
  j["seconds"] = {{"build", t.build},
                  {"pipeline", t.pipeline},
                  {"frames", t.frames},
                  {"median_frame", t.median_frame()},
                  {"pipeline_cpu", t.pipeline_cpu},
                  {"frames_cpu", t.frames_cpu}};
  if (in.settings.count_rays) {
    const auto counts = in.renderer.ray_counts();
    j["rays"] = {
        {"primary", counts[gpu::kRayPrimary]},       {"bounce", counts[gpu::kRayBounce]},
        {"shadow", counts[gpu::kRayShadow]},         {"occlusion", counts[gpu::kRayOcclusion]},
        {"reflection", counts[gpu::kRayReflection]}, {"refraction", counts[gpu::kRayRefraction]}};
  }
  j["device"] = in.device;
  j["driver"] = in.driver;
  return j.dump(2) + "\n";
}

std::string effects_table(const std::vector<effects::Call>& calls, const effects::Choice& choice) {
  std::string text;
  for (const effects::Call& call : calls) {
    if (!call.needed() && !choice.has(call.effect.bit)) {
      continue;
    }
    std::string who;
    for (const std::string& name : call.called_for_by) {
      who += (who.empty() ? "" : ", ") + name;
    }
    std::string name = call.effect.name;
    name.resize(12, ' ');
    text += "  " + name + (who.empty() ? "nothing calls for it" : "called for by " + who) +
            (choice.has(call.effect.bit) ? "" : " (left out)") + "\n";
  }
  return text;
}

}  // namespace a2rt::render
