#include "render/options.h"

#include <CLI/CLI.hpp>

#include "a2rt/base/error.h"

namespace a2rt::render {
namespace {

void parse_size(const std::string& text, Options& o) {
  unsigned width = 0, height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%ux%u%c", &width, &height, &rest) != 2 || width == 0 ||
      height == 0 || width > 16384 || height > 16384) {
    throw UserError("--size " + text + ": write WIDTHxHEIGHT, each from 1 to 16384");
  }
  o.width = width;
  o.height = height;
}

void add_what(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.scene, "a .gltf or .glb file, or the name of an embedded scene");
  app.add_option("-w,--workload", o.workload, "auto, or a name from lumibench_configs/workloads");
  app.add_option("--effects", o.effects,
                 "auto (what the scene calls for), all, or a comma-separated list");
  app.add_option("--camera", o.camera,
                 "name or number of a camera of the file, 'auto', or ex,ey,ez/cx,cy,cz/degrees");
  app.add_option("--sky", o.sky, "auto, on or off")->check(CLI::IsMember({"auto", "on", "off"}));
  app.add_flag("--list-effects", o.list_effects,
               "print which effects are called for, as JSON, and draw nothing");
  app.add_flag("--list-scenes", o.list_scenes, "print the embedded scenes");
  app.add_flag("--list-workloads", o.list_workloads, "print the workloads");
}

void add_how(CLI::App& app, Options& o) {
  app.add_option("--spp", o.samples, "samples per pixel")->check(CLI::Range(1, 1 << 20));
  app.add_option("--frames", o.frames, "frames, averaged")->check(CLI::Range(1, 1 << 16));
  app.add_option("--seed", o.seed, "the picture depends on it and on nothing random");
  app.add_option("--max-bounces", o.max_bounces, "rays of a path at most")
      ->check(CLI::Range(1, 1024));
  app.add_option("--shadow-rays", o.shadow_rays, "shadow rays per primary hit")
      ->check(CLI::Range(0, 4096));
  app.add_option("--ao-rays", o.ao_rays, "ambient-occlusion rays per primary hit")
      ->check(CLI::Range(0, 4096));
  app.add_option("--ao-distance", o.ao_distance,
                 "reach of ambient-occlusion rays: world units, or relative:SHARE of the scene");
  app.add_option("--exposure", o.exposure, "factor of the 8-bit picture")
      ->check(CLI::PositiveNumber);
  app.add_flag("--lumibench-shadow", o.lumibench_shadow,
               "shadow rays run the closest-hit shader, as LumiBench's do");
  app.add_flag("--no-missing-textures", o.strict_textures,
               "an image that cannot be found is an error, not a warning");
  app.add_option("--samples-per-dispatch", o.samples_per_dispatch,
                 "cut a frame into dispatches; 0: only very long frames are cut");
}

void add_results(CLI::App& app, Options& o) {
  app.add_option("-o,--output", o.png, "PNG picture");
  app.add_option("--hdr", o.hdr, "PFM picture: linear floats");
  app.add_option("--json", o.json, "statistics: counts, effects, times");
  app.add_option("--export-gltf", o.export_gltf, "write the scene as .glb or .gltf");
  app.add_flag("--count-rays", o.count_rays, "count rays by kind (slower)");
  app.add_option("--timing", o.timing, "draw the frame N more times and report the median");
  app.add_flag("-q,--quiet", o.quiet, "no progress and no summary");
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& status) {
  CLI::App app{"Draws a scene with Vulkan ray tracing on lavapipe.", "a2rt-render"};
  Options o;
  std::string size;
  add_what(app, o);
  app.add_option("--size", size, "WIDTHxHEIGHT of the picture");
  add_how(app, o);
  add_results(app, o);
  app.footer(
      "Examples:\n"
      "  a2rt-render cornell -o cornell.png --size 256x256 --spp 64\n"
      "  a2rt-render scene.glb --workload ao -o ao.png\n"
      "  a2rt-render scene.glb --list-effects\n"
      "Exit status: 0 done, 2 wrong input, 3 internal error.");
  try {
    app.parse(argc, argv);
    if (!size.empty()) {
      parse_size(size, o);
    }
  } catch (const CLI::ParseError& e) {
    status = app.exit(e) == 0 ? 0 : 2;
    return std::nullopt;
  }
  if (o.scene.empty() && !o.list_scenes && !o.list_workloads) {
    throw UserError("name a scene: a glTF file or an embedded scene (--list-scenes)");
  }
  return o;
}

}  // namespace a2rt::render
