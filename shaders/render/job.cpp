#include "render/job.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <glm/geometric.hpp>

#include "a2rt/base/error.h"
#include "embedded/embedded.h"
#include "gltf/exporter.h"
#include "gltf/loader.h"
#include "render/output.h"
#include "render/renderer.h"
#include "render/report.h"
#include "scene/mesh_builder.h"

namespace a2rt::render {
namespace {

scene::Camera camera_from_text(const std::string& text) {
  glm::vec3 eye, centre;
  float fov = 40;
  char rest = 0;
  const int read = std::sscanf(text.c_str(), "%f,%f,%f/%f,%f,%f/%f%c", &eye.x, &eye.y, &eye.z,
                               &centre.x, &centre.y, &centre.z, &fov, &rest);
  if (read != 6 && read != 7) {
    throw UserError("--camera " + text + ": write eye/centre/degrees, e.g. 0,1,5/0,0,0/40");
  }
  if (!(glm::length(centre - eye) > 0) || !(fov > 0 && fov < 180)) {
    throw UserError("--camera " + text +
                    ": it sees no area; eye and centre must differ and the angle must lie between "
                    "0 and 180 degrees");
  }
  return scene::look_at("command line", eye, centre, fov);
}

void show_lists(const Options& options) {
  if (options.list_scenes) {
    for (const auto& scene : embedded::all()) {
      std::printf("%-10s %s\n", scene.name.c_str(), scene.sentence.c_str());
    }
  }
  if (options.list_workloads) {
    for (const std::string& name : workloads::names()) {
      std::printf("%-10s %s\n", name.c_str(), workloads::load(name).title.c_str());
    }
  }
}

// One line that rewrites itself, on terminals only.
Progress progress_line(const Options& options) {
  if (options.quiet || isatty(STDERR_FILENO) == 0) {
    return {};
  }
  return [](std::uint64_t done, std::uint64_t all) {
    std::fprintf(stderr, "\r%3.0f %% (%llu of %llu samples per pixel)%s",
                 100.0 * static_cast<double>(done) / static_cast<double>(all),
                 static_cast<unsigned long long>(done), static_cast<unsigned long long>(all),
                 done == all ? "\n" : "");
  };
}

void summary(const ReportInput& in) {
  const scene::Counts counts = scene::count(in.scene);
  const Timings& t = in.renderer.timings();
  std::fprintf(stderr,
               "%s: %llu triangles (%llu drawn), %llu shapes, %llu instances; workload %s\n",
               in.scene.name.c_str(), static_cast<unsigned long long>(counts.triangles),
               static_cast<unsigned long long>(counts.drawn_triangles),
               static_cast<unsigned long long>(counts.shapes),
               static_cast<unsigned long long>(counts.instances), in.workload.name.c_str());
  std::fprintf(stderr, "%s", effects_table(in.calls, in.choice).c_str());
  for (const std::string& name : in.choice.lacking) {
    std::fprintf(stderr, "  the picture lacks %s\n", name.c_str());
  }
  if (in.workload.clamp_indirect > 0) {
    std::fprintf(stderr,
                 "  light by way of diffuse hits is limited to %g a sample (--clamp-indirect 0: "
                 "no limit)\n",
                 in.workload.clamp_indirect);
  }
  std::fprintf(stderr, "build %.2f s, pipeline %.2f s, frame %.3f s (median of %zu)\n", t.build,
               t.pipeline, t.median_frame(), t.frames.size());
}

// Without instancing every placement is a copy in memory.
void check_copies(const scene::Scene& scene, const effects::Choice& choice, bool quiet) {
  constexpr std::uint64_t kMost = 32'000'000;  // about 4 GB of vertices, indices and structures
  const scene::Counts counts = scene::count(scene);
  const bool copies =
      (choice.called_for & gpu::kEffectInstancing) != 0 && !choice.has(gpu::kEffectInstancing);
  if (copies && counts.drawn_triangles > kMost) {
    throw UserError("scene '" + scene.name + "' has " + std::to_string(counts.drawn_triangles) +
                    " triangles without instancing, more than " + std::to_string(kMost) +
                    "; add instancing to --effects");
  }
  if (copies && !quiet) {
    std::fprintf(stderr, "  without instancing: %llu triangles are stored instead of %llu\n",
                 static_cast<unsigned long long>(counts.drawn_triangles),
                 static_cast<unsigned long long>(counts.triangles));
  }
}

void draw(const Options& options, const scene::Scene& scene) {
  const workloads::WorkloadConfig workload = choose_workload(scene, options);
  const auto calls = effects::analyse(scene, workload);
  const auto choice = effects::choose(calls, options.effects);
  if (options.list_effects) {
    std::fputs(effects_json(calls, choice, workload).c_str(), stdout);
    return;
  }
  check_copies(scene, choice, options.quiet);
  const scene::Camera camera = choose_camera(scene, options.camera);
  const Settings settings = make_settings(scene, workload, options);
  make_frame(scene, camera, workload, settings);  // a camera that sees nothing fails here
  const vulkan::Context context;
  Renderer renderer(context, scene, camera, workload, choice, settings);
  const Picture picture = renderer.render(options.samples_per_dispatch, progress_line(options));
  if (options.timing > 0) {
    renderer.measure(options.timing);
  }
  const ReportInput report{scene,
                           camera,
                           workload,
                           calls,
                           choice,
                           settings,
                           renderer,
                           context.device_name(),
                           context.driver_info()};
  if (!options.png.empty()) {
    write_png(options.png, picture);
  }
  if (!options.hdr.empty()) {
    write_pfm(options.hdr, picture);
  }
  if (!options.json.empty()) {
    write_text(options.json, stats_json(report));
  }
  if (!options.quiet) {
    summary(report);
  }
}

}  // namespace

scene::Scene load_scene(const Options& options) {
  const std::filesystem::path file = options.scene;
  const bool named = !file.has_extension() && !std::filesystem::exists(file);
  scene::Scene scene = named || embedded::exists(options.scene)
                           ? embedded::make(options.scene)
                           : gltf::load(file, {!options.strict_textures});
  if (options.sky != "auto") {
    scene.sky.present = options.sky == "on";
  }
  scene::validate(scene);
  return scene;
}

workloads::WorkloadConfig choose_workload(const scene::Scene& scene, const Options& options) {
  std::string name = options.workload;
  if (name == "auto") {
    bool lit = false;
    for (const scene::Material& m : scene.materials) {
      lit = lit || m.emission != glm::vec3(0);
    }
    name = lit && !scene.lumibench ? "ptl" : "pt";
  }
  workloads::WorkloadConfig w = workloads::load(name);
  w.max_bounces = options.max_bounces.value_or(w.max_bounces);
  w.shadow_rays = options.shadow_rays.value_or(w.shadow_rays);
  w.clamp_indirect = options.clamp_indirect.value_or(w.clamp_indirect);
  w.ao_rays = options.ao_rays.value_or(w.ao_rays);
  if (w.recursion > 1 && w.max_bounces >= w.recursion) {
    throw UserError("workload " + name + " nests its rays: at most " +
                    std::to_string(w.recursion - 1) + " bounces, not " +
                    std::to_string(w.max_bounces));
  }
  return w;
}

scene::Camera choose_camera(const scene::Scene& scene, const std::string& name) {
  if (name.find('/') != std::string::npos) {
    return camera_from_text(name);
  }
  if (name == "auto" || (name.empty() && scene.cameras.empty())) {
    return scene::frame_automatically(scene::world_bounds(scene));
  }
  if (name.empty()) {
    return scene.cameras.front();
  }
  std::string known;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    if (scene.cameras[i].name == name || std::to_string(i) == name) {
      return scene.cameras[i];
    }
    known += ", " + scene.cameras[i].name;
  }
  throw UserError("no camera '" + name + "' in scene '" + scene.name + "'; known: auto" + known);
}

Settings make_settings(const scene::Scene& scene, const workloads::WorkloadConfig& workload,
                       const Options& options) {
  Settings s;
  s.width = options.width.value_or(workload.width);
  s.height = options.height.value_or(workload.height);
  s.samples = options.samples.value_or(workload.samples);
  s.frames = options.frames;
  s.seed = options.seed;
  s.exposure = options.exposure;
  s.lumibench_shadow = options.lumibench_shadow;
  s.count_rays = options.count_rays;
  if (!options.ao_distance.empty()) {
    const std::string relative = "relative:";
    const bool share = options.ao_distance.starts_with(relative);
    const std::string number =
        share ? options.ao_distance.substr(relative.size()) : options.ao_distance;
    char* end = nullptr;
    s.ao_distance = std::strtof(number.c_str(), &end);
    if (number.empty() || *end != '\0' || !(s.ao_distance > 0) || !std::isfinite(s.ao_distance)) {
      throw UserError("--ao-distance " + options.ao_distance +
                      ": write a length above 0, or relative:SHARE");
    }
    s.ao_distance *= share ? scene::world_bounds(scene).diagonal() : 1;
  }
  return s;
}

void run(const Options& options) {
  show_lists(options);
  if (options.scene.empty()) {
    return;
  }
  const scene::Scene scene = load_scene(options);
  for (const std::string& warning : scene.warnings) {
    std::fprintf(stderr, "a2rt-render: warning: %s: %s\n", scene.name.c_str(), warning.c_str());
  }
  if (!options.export_gltf.empty()) {
    gltf::save(scene, options.export_gltf);
    if (options.png.empty() && options.hdr.empty() && options.json.empty()) {
      return;
    }
  }
  draw(options, scene);
}

}  // namespace a2rt::render
