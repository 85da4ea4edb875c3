#include "a2rt/workload/effects.h"

#include <algorithm>
#include <array>
#include <set>

#include "a2rt/capture/records.h"
#include "a2rt/workload/reference.h"

namespace a2rt {
namespace {

using capture::Stage;

// What names an effect in tables, whatever the workload.
struct Description {
  const char* name;
  const char* stages;
  const char* parts;
  const char* needs;  // completes "none: no ..."
};
constexpr std::array<Description, kEffectCount> kDescriptions{{
    {"triangles", "-", "triangle tester", "triangle geometry"},
    {"procedural", "intersection", "intersection-shader path", "box geometry"},
    {"any_hit", "any-hit", "any-hit candidate path", "candidate that a shader judged"},
    {"transform", "-", "transform unit", "instance with a transform other than the identity"},
    {"instancing", "-", "-", "structure with several instances"},
    {"masks", "-", "mask test", "instance or ray with a mask other than 0xff"},
    {"face_culling", "-", "facing test", "ray with a face-culling flag"},
    {"opacity_flags", "-", "opacity logic", "ray or instance that overrides opacity"},
    {"skip_geometry", "-", "geometry filter", "ray that skips triangles or boxes"},
    {"first_hit", "-", "first-hit exit", "ray that ends at its first hit"},
    {"closest_hit", "closest-hit, miss", "-", "ray that wants the closest hit"},
    {"secondary_rays", "-", "-", "launch id with a second ray"},
    {"recursion", "closest-hit, miss", "call stack", "ray traced by a hit or miss shader"},
    {"ray_query", "compute, fragment or any", "inline traversal", "ray query"},
    {"callable", "callable", "callable calls", "callable shader"},
    {"textures", "-", "texture unit", "texture or image instruction"},
    {"several_frames", "-", "-", "second frame"},
    {"dynamic_geometry", "-", "-", "second version of a structure"},
}};

std::string plural(std::uint64_t count, const std::string& one, const std::string& many = "") {
  return std::to_string(count) + " " + (count == 1 ? one : many.empty() ? one + "s" : many);
}

class Deriver {
 public:
  explicit Deriver(const Workload& workload) : w_(workload) {
    for (std::size_t i = 0; i < kEffectCount; ++i) {
      const Description& d = kDescriptions[i];
      effects_.uses.push_back({static_cast<Effect>(i), d.name, false, 0,
                               std::string("no ") + d.needs, d.stages, d.parts});
    }
  }

  Effects run() {
    structures();
    rays();
    candidates();
    segments();
    frames();
    return std::move(effects_);
  }

 private:
  void use(Effect effect, std::uint64_t count, const std::string& reason) {
    if (count > 0) {
      EffectUse& u = effects_.uses[static_cast<std::size_t>(effect)];
      u.used = true;
      u.reason = reason;
    }
  }
  void use_rays(Effect effect, std::uint64_t rays, const std::string& reason) {
    use(effect, rays, reason);
    effects_.uses[static_cast<std::size_t>(effect)].rays = rays;
  }

  std::uint64_t rays_of(const std::set<std::uint32_t>& tlas) const {
    return static_cast<std::uint64_t>(std::count_if(
        w_.rays.begin(), w_.rays.end(), [&](const Ray& r) { return tlas.contains(r.tlas); }));
  }

  void structures() {
    std::uint64_t triangles = 0, boxes = 0, transformed = 0, masked = 0, opacity = 0;
    for (const Blas& b : w_.blas) {
      // Without primitives (a partial read) geometries cannot be told apart; both counts stay 0.
      triangles += b.triangles.size();
      boxes += b.aabbs.size();
    }
    std::set<std::uint32_t> with_transform, with_several;
    for (std::uint32_t t = 0; t < w_.tlas.size(); ++t) {
      for (const Instance& i : w_.tlas[t].instances) {
        const bool moved = !(i.object_to_world == Affine{});
        transformed += moved ? 1 : 0;
        masked += (i.mask & 0xff) != 0xff ? 1 : 0;
        opacity += (i.flags & (kInstanceForceOpaque | kInstanceForceNoOpaque)) != 0 ? 1 : 0;
        if (moved) {
          with_transform.insert(t);
        }
      }
      if (w_.tlas[t].instances.size() > 1) {
        with_several.insert(t);
      }
    }
    use(Effect::kTriangles, triangles, plural(triangles, "triangle"));
    use(Effect::kProcedural, boxes, plural(boxes, "box", "boxes"));
    use(Effect::kTransform, transformed, plural(transformed, "instance") + " with a transform");
    use(Effect::kMasks, masked, plural(masked, "instance") + " with a mask");
    use(Effect::kOpacityFlags, opacity, plural(opacity, "instance") + " that force opacity");
    use_rays(Effect::kTransform, transformed > 0 ? rays_of(with_transform) : 0,
             plural(transformed, "instance") + " with a transform");
    use_rays(Effect::kInstancing, with_several.empty() ? 0 : rays_of(with_several),
             plural(with_several.size(), "structure") + " with several instances");
  }

  std::uint64_t count_rays(std::uint32_t flags) const {
    return static_cast<std::uint64_t>(std::count_if(
        w_.rays.begin(), w_.rays.end(), [&](const Ray& r) { return (r.flags & flags) != 0; }));
  }
  void by_flag(Effect effect, std::uint32_t flags, const std::string& what) {
    const std::uint64_t rays = count_rays(flags);
    if (rays > 0) {
      use_rays(effect, rays, plural(rays, "ray") + " " + what);
    }
  }

  void rays() {
    by_flag(Effect::kFaceCulling, kRayCullBackFacing | kRayCullFrontFacing, "cull by facing");
    by_flag(Effect::kOpacityFlags, kRayOpaque | kRayNoOpaque | kRayCullOpaque | kRayCullNoOpaque,
            "override or cull by opacity");
    by_flag(Effect::kSkipGeometry, kRaySkipTriangles | kRaySkipAabbs, "skip geometry");
    by_flag(Effect::kFirstHit, kRayTerminateOnFirstHit, "end at their first hit");
    by_flag(Effect::kRayQuery, kRayQuery, "are ray queries");
    std::uint64_t masked = 0, secondary = 0, nested = 0;
    for (const Ray& r : w_.rays) {
      masked += r.mask != 0xff ? 1 : 0;
      secondary += r.ordinal > 0 ? 1 : 0;
      nested += r.parent != kNone ? 1 : 0;
    }
    if (masked > 0) {
      use_rays(Effect::kMasks, masked, plural(masked, "ray") + " with a mask");
    }
    use_rays(Effect::kSecondaryRays, secondary, plural(secondary, "ray") + " after the first");
    use_rays(Effect::kRecursion, nested, plural(nested, "ray") + " traced by hit or miss shaders");
    const std::uint64_t closest = w_.rays.size() - count_rays(kRayTerminateOnFirstHit);
    use_rays(Effect::kClosestHit, closest, plural(closest, "ray") + " want the closest hit");
  }

  void candidates() {
    std::uint64_t judged = 0, reported = 0;
    for (std::size_t i = 0; i < w_.rays.size(); ++i) {
      const auto own = candidates_of(w_, i);
      const auto is_report = [](const Candidate& c) { return c.is_report != 0; };
      reported += std::any_of(own.begin(), own.end(), is_report) ? 1U : 0U;
      judged += !std::all_of(own.begin(), own.end(), is_report) ? 1U : 0U;
    }
    use_rays(Effect::kAnyHit, judged, plural(judged, "ray") + " with judged candidates");
    if (reported > 0) {
      use_rays(Effect::kProcedural, reported,
               plural(reported, "ray") + " with reported intersections");
    }
    effects_.uses[static_cast<std::size_t>(Effect::kTriangles)].rays =
        effects_.used(Effect::kTriangles) ? w_.rays.size() : 0;
  }

  void segments() {
    std::uint64_t callables = 0, textures = 0;
    for (const Segment& s : w_.segments) {
      callables += w_.shaders[s.shader].stage == static_cast<std::uint32_t>(Stage::kCallable);
      textures += s.counts[static_cast<std::size_t>(capture::Counter::kTexture)];
    }
    use(Effect::kCallable, callables, plural(callables, "segment") + " of callable shaders");
    use(Effect::kTextures, textures, plural(textures, "texture or image instruction"));
  }

  void frames() {
    std::set<std::uint32_t> frames;
    for (const Dispatch& d : w_.dispatches) {
      frames.insert(d.frame);
    }
    use(Effect::kSeveralFrames, frames.size() > 1 ? 1 : 0, plural(frames.size(), "frame"));
    use(Effect::kDynamicGeometry, w_.tlas.size() > 1 ? 1 : 0,
        plural(w_.tlas.size(), "version") + " of top-level structures");
  }

  const Workload& w_;
  Effects effects_;
};

}  // namespace

Effects derive_effects(const Workload& workload) { return Deriver(workload).run(); }

}  // namespace a2rt
