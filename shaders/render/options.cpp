#include "render/options.h"

#include "a2rt/base/error.h"
#include "a2rt/cli/options.h"

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

void add_what(cli::Options& app, Options& o) {
  app.add("SCENE", o.scene, "a .gltf or .glb file, or the name of an embedded scene");
  app.add("-w,--workload", o.workload, "auto, or a name from lumibench_configs/workloads");
  app.add("--effects", o.effects,
          "auto (what the scene calls for), all, or a comma-separated list");
  app.add("--camera", o.camera,
          "name or number of a camera of the file, 'auto', or ex,ey,ez/cx,cy,cz/degrees");
  app.add("--sky", o.sky, "auto, on or off").check(cli::one_of({"auto", "on", "off"}));
  app.flag("--list-effects", o.list_effects,
           "print which effects are called for, as JSON, and draw nothing");
  app.flag("--list-scenes", o.list_scenes, "print the embedded scenes");
  app.flag("--list-workloads", o.list_workloads, "print the workloads");
}

void add_how(cli::Options& app, Options& o) {
  app.add("--spp", o.samples, "samples per pixel").check(cli::in_range(1, 1 << 20));
  app.add("--frames", o.frames, "frames, averaged").check(cli::in_range(1, 1 << 16));
  app.add("--seed", o.seed, "the picture depends on it and on nothing random");
  app.add("--max-bounces", o.max_bounces, "rays of a path at most").check(cli::in_range(1, 1024));
  app.add("--clamp-indirect", o.clamp_indirect,
          "most that a sample adds by way of a diffuse hit; 0: no limit")
      .check(cli::in_range(0, 1e30));
  app.add("--shadow-rays", o.shadow_rays, "shadow rays per primary hit")
      .check(cli::in_range(0, 4096));
  app.add("--ao-rays", o.ao_rays, "ambient-occlusion rays per primary hit")
      .check(cli::in_range(0, 4096));
  app.add("--ao-distance", o.ao_distance,
          "reach of ambient-occlusion rays: world units, or relative:SHARE of the scene");
  app.add("--exposure", o.exposure, "factor of the 8-bit picture").check(cli::positive());
  app.flag("--lumibench-shadow", o.lumibench_shadow,
           "shadow rays run the closest-hit shader, as LumiBench's do");
  app.flag("--no-missing-textures", o.strict_textures,
           "an image that cannot be found is an error, not a warning");
  app.add("--samples-per-dispatch", o.samples_per_dispatch,
          "cut a frame into dispatches; 0: only very long frames are cut");
}

void add_results(cli::Options& app, Options& o) {
  app.add("-o,--output", o.png, "PNG picture");
  app.add("--hdr", o.hdr, "PFM picture: linear floats");
  app.add("--json", o.json, "statistics: counts, effects, times");
  app.add("--export-gltf", o.export_gltf, "write the scene as .glb or .gltf");
  app.flag("--count-rays", o.count_rays, "count rays by kind (slower)");
  app.add("--timing", o.timing, "draw the frame N more times and report the median");
  app.flag("-q,--quiet", o.quiet, "no progress and no summary");
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& status) {
  cli::Program program("Draws a scene with Vulkan ray tracing on lavapipe.", "a2rt-render");
  cli::Options app = program.options();
  Options o;
  std::string size;
  add_what(app, o);
  app.add("--size", size, "WIDTHxHEIGHT of the picture");
  add_how(app, o);
  add_results(app, o);
  program.footer(
      "Examples:\n"
      "  a2rt-render cornell -o cornell.png --size 256x256 --spp 64\n"
      "  a2rt-render scene.glb --workload ao -o ao.png\n"
      "  a2rt-render scene.glb --list-effects\n"
      "Exit status: 0 done, 2 wrong input, 3 internal error.");
  if (const std::optional<int> ended = program.parse(argc, argv, 2)) {
    status = *ended;
    return std::nullopt;
  }
  if (!size.empty()) {
    parse_size(size, o);
  }
  if (o.scene.empty() && !o.list_scenes && !o.list_workloads) {
    throw UserError("name a scene: a glTF file or an embedded scene (--list-scenes)");
  }
  return o;
}

}  // namespace a2rt::render
