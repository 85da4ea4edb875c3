#include "a2rt/workload/parts.h"

#include <algorithm>
#include <array>

#include "a2rt/capture/records.h"

namespace a2rt {
namespace {

using capture::Stage;

struct Description {
  const char* name;
  const char* cause;
};
constexpr std::array<Description, kPartCount> kDescriptions{{
    {"triangle tester", "triangle"},
    {"intersection-shader path", "box with an intersection shader"},
    {"any-hit candidate path", "triangle that is not opaque, with a shader to judge it"},
    {"transform unit", "instance with a transform other than the identity"},
    {"mask test", "instance or ray with a mask other than 0xff"},
    {"facing test", "ray that culls by facing"},
    {"opacity logic", "ray or instance that overrides opacity"},
    {"geometry filter", "ray that skips triangles or boxes"},
    {"first-hit exit", "ray that ends at its first hit"},
    {"call stack", "ray traced by a hit or miss shader"},
    {"inline traversal", "ray query"},
    {"callable calls", "callable shader"},
    {"texture unit", "texture or image instruction"},
}};

bool has_stage(const Workload& w, Stage stage) {
  return std::any_of(w.shaders.begin(), w.shaders.end(), [stage](const Shader& s) {
    return s.stage == static_cast<std::uint32_t>(stage);
  });
}

// Which structures rays can reach: those that some instance places.
void add_structures(const Workload& w, Parts& parts) {
  std::vector<bool> placed(w.blas.size(), false);
  for (const Tlas& tlas : w.tlas) {
    for (const Instance& i : tlas.instances) {
      if (i.blas >= w.blas.size()) {
        continue;
      }
      placed[i.blas] = true;
      if (!(i.object_to_world == Affine{})) {
        parts.add(Part::kTransformUnit);
      }
      if ((i.mask & 0xffU) != 0xffU) {
        parts.add(Part::kMaskTest);
      }
      if ((i.flags & (kInstanceForceOpaque | kInstanceForceNoOpaque)) != 0) {
        parts.add(Part::kOpacityLogic);
      }
    }
  }
  for (std::size_t b = 0; b < w.blas.size(); ++b) {
    if (placed[b] && !w.blas[b].triangles.empty()) {
      parts.add(Part::kTriangleTester);
    }
    if (placed[b] && !w.blas[b].aabbs.empty()) {
      parts.add(Part::kIntersectionPath);
    }
  }
}

void add_rays(const Workload& w, Parts& parts) {
  constexpr std::array<std::pair<std::uint32_t, Part>, 5> kByFlag{{
      {kRayCullBackFacing | kRayCullFrontFacing, Part::kFacingTest},
      {kRayOpaque | kRayNoOpaque | kRayCullOpaque | kRayCullNoOpaque, Part::kOpacityLogic},
      {kRaySkipTriangles | kRaySkipAabbs, Part::kGeometryFilter},
      {kRayTerminateOnFirstHit, Part::kFirstHitExit},
      {kRayQuery, Part::kInlineTraversal},
  }};
  std::uint32_t flags = 0;
  for (const Ray& r : w.rays) {
    flags |= r.flags;
    if ((r.mask & 0xffU) != 0xffU) {
      parts.add(Part::kMaskTest);
    }
    if (r.parent != kNone) {
      parts.add(Part::kCallStack);
    }
  }
  for (const auto& [mask, part] : kByFlag) {
    if ((flags & mask) != 0) {
      parts.add(part);
    }
  }
}

void add_segments(const Workload& w, Parts& parts) {
  constexpr auto kTexture = static_cast<std::size_t>(capture::Counter::kTexture);
  for (const Segment& s : w.segments) {
    if (w.shaders[s.shader].stage == static_cast<std::uint32_t>(Stage::kCallable)) {
      parts.add(Part::kCallableCalls);
    }
    if (s.counts[kTexture] != 0) {
      parts.add(Part::kTextureUnit);
    }
  }
}

// Non-opaque triangles that some ray can meet as such.
bool shows_non_opaque(const Workload& w) {
  const bool all_opaque = std::all_of(w.rays.begin(), w.rays.end(),
                                      [](const Ray& r) { return (r.flags & kRayOpaque) != 0; });
  if (all_opaque) {
    return false;
  }
  const bool forced_by_ray = std::any_of(
      w.rays.begin(), w.rays.end(), [](const Ray& r) { return (r.flags & kRayNoOpaque) != 0; });
  for (const Tlas& tlas : w.tlas) {
    for (const Instance& i : tlas.instances) {
      if (i.blas >= w.blas.size() || w.blas[i.blas].triangles.empty()) {
        continue;
      }
      const auto& geometries = w.blas[i.blas].geometries;
      const bool open = std::any_of(geometries.begin(), geometries.end(),
                                    [](const Geometry& g) { return !g.opaque && g.count > 0; });
      const bool forced = (i.flags & kInstanceForceNoOpaque) != 0 || forced_by_ray;
      if (forced || (open && (i.flags & kInstanceForceOpaque) == 0)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool judges_candidates(const Workload& w) {
  // A ray query is its own judge; it is not an any-hit stage.
  return has_stage(w, Stage::kAnyHit) ||
         std::any_of(w.rays.begin(), w.rays.end(),
                     [](const Ray& r) { return (r.flags & kRayQuery) != 0; });
}

Parts parts_called_for(const Workload& w) {
  Parts parts;
  add_structures(w, parts);
  add_rays(w, parts);
  add_segments(w, parts);
  const bool judged = std::any_of(w.candidates.begin(), w.candidates.end(),
                                  [](const Candidate& c) { return c.is_report == 0; });
  if (judged || (judges_candidates(w) && shows_non_opaque(w))) {
    parts.add(Part::kAnyHitPath);
  }
  return parts;
}

const char* part_name(Part part) { return kDescriptions[static_cast<std::size_t>(part)].name; }
const char* part_cause(Part part) { return kDescriptions[static_cast<std::size_t>(part)].cause; }

}  // namespace a2rt
