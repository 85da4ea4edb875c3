#include "workloads/workload_config.h"

#include <algorithm>
#include <cstdlib>

#include "a2rt/base/error.h"
#include "a2rt/config/section.h"
#include "effects/effect.h"

namespace a2rt::workloads {
namespace {

std::uint32_t natural(const config::Section& s, const std::string& key, std::int64_t fallback,
                      std::int64_t least, std::int64_t most, const std::string& sentence) {
  return static_cast<std::uint32_t>(s.integer(key, fallback, least, most, "", sentence));
}

void read_stages(const config::Section& s, WorkloadConfig& w) {
  w.ray_generation = s.text("ray_generation", w.name, "ray-generation shader");
  w.triangle_closest_hit = s.text("triangle_closest_hit", "triangle", "closest hit of triangles");
  w.shape_closest_hit = s.text("shape_closest_hit", "shape", "closest hit of procedural shapes");
  w.misses = s.texts("misses", {"path", "shadow"}, "miss shaders, by miss index");
  for (const char* key :
       {"ray_generation", "triangle_closest_hit", "shape_closest_hit", "misses"}) {
    w.stage_places[key] = s.where(key);
  }
  w.recursion = natural(s, "recursion", 1, 1, 31, "deepest nesting of traces");
}

void read_sampling(const config::Section& s, WorkloadConfig& w) {
  w.width = natural(s, "width", 128, 1, 16384, "pixels across");
  w.height = natural(s, "height", 128, 1, 16384, "pixels down");
  w.samples = natural(s, "samples", 2, 1, 1 << 20, "samples per pixel");
  w.max_bounces = natural(s, "max_bounces", 16, 1, 1024, "rays of one path at most");
  w.shadow_rays = natural(s, "shadow_rays", 0, 0, 4096, "shadow rays per primary hit");
  w.ao_rays = natural(s, "ao_rays", 0, 0, 4096, "ambient-occlusion rays per primary hit");
  w.ao_distance =
      s.number("ao_distance", 0.03, 0, 1e6, "scene diagonals", "reach of ambient-occlusion rays");
  w.ao_lumibench = s.number("ao_lumibench", 10, 0, 1e30, "scene units",
                            "the same in scenes that carry LumiBench's extras");
  w.shadow_factor = s.number("shadow_factor", 0.3, 0, 1, "", "colour factor of each blocked ray");
  w.ao_factor = s.number("ao_factor", 0.9, 0, 1, "", "colour factor of each blocked ray");
  w.clamp_indirect =
      s.number("clamp_indirect", 0, 0, 1e30, "radiance",
               "most that a sample adds by way of a diffuse hit; trades caustics for less noise");
  w.light_sampling = s.boolean("light_sampling", false, "sample emitters by shadow rays");
  w.sun = s.boolean("sun", false, "scenes without a light get a sun from a fixed direction");
  w.opaque_geometry =
      s.boolean("opaque_geometry", true, "triangles without alpha bypass the any-hit shader");
}

void check_effects(const config::Section& root, const WorkloadConfig& w) {
  for (const std::string& name : w.effects) {
    const auto& all = effects::all();
    if (std::any_of(all.begin(), all.end(), [&](const auto& one) { return one.name == name; })) {
      continue;
    }
    std::string known;
    for (const effects::Effect& one : all) {
      known += (known.empty() ? "" : ", ") + one.name;
    }
    throw UserError(root.where("effects") + ": no effect '" + name +
                    "'; list those of the shaders: " + known);
  }
}

}  // namespace

std::filesystem::path config_folder() {
  const char* chosen = std::getenv("A2RT_CONFIGS");
  return chosen != nullptr && *chosen != '\0' ? std::filesystem::path(chosen)
                                              : std::filesystem::path(A2RT_CONFIG_FOLDER);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(config_folder() / "workloads", error)) {
    if (entry.path().extension() == ".toml") {
      all.push_back(entry.path().stem().string());
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

WorkloadConfig load(const std::string& name) {
  const std::filesystem::path file = config_folder() / "workloads" / (name + ".toml");
  const std::vector<std::string> known = names();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    std::string list;
    for (const std::string& n : known) {
      list += (list.empty() ? "" : ", ") + n;
    }
    throw UserError("no workload '" + name + "' in " + file.parent_path().string() +
                    "; known: auto" + (list.empty() ? "" : ", " + list));
  }
  const config::Section root = config::Section::from_file(file);
  WorkloadConfig w;
  w.name = name;
  w.title = root.text("title", name, "what it draws, in words");
  w.lumibench = root.text("lumibench", "", "LumiBench's shader type, if it has one");
  w.effects = root.texts("effects", {}, "effects its shaders can show");
  check_effects(root, w);
  w.rays = root.texts("rays", {}, "rays it traces, in words");
  read_stages(root.table("stages"), w);
  read_sampling(root.table("sampling"), w);
  root.reject_unknown_keys();
  return w;
}

}  // namespace a2rt::workloads
