// "Simulate only the effects a scene calls for": what a workload uses, derived from its rays,
// flags, geometry, shader stages and instances.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt {

enum class Effect : std::uint8_t {
  kTriangles,       // triangle tester
  kProcedural,      // boxes with intersection shaders
  kAnyHit,          // candidates judged by a shader
  kTransform,       // an instance whose transform is not the identity
  kInstancing,      // several instances in one structure
  kMasks,           // instance masks that can exclude something
  kFaceCulling,     // rays that cull by facing
  kOpacityFlags,    // rays or instances that override opacity or cull by it
  kSkipGeometry,    // rays that skip triangles or boxes
  kFirstHit,        // occlusion rays: terminate on the first hit
  kClosestHit,      // rays that want the closest hit
  kSecondaryRays,   // rays that depend on the result of another one
  kRecursion,       // rays traced by closest-hit or miss shaders
  kRayQuery,        // inline rays of compute, fragment or ray-tracing shaders
  kCallable,        // callable shaders
  kTextures,        // texture instructions between the rays
  kSeveralFrames,   // more than one frame
  kDynamicGeometry  // dispatches that see different versions of a structure
};
inline constexpr std::size_t kEffectCount = 18;

struct EffectUse {
  Effect effect = Effect::kTriangles;
  std::string name;  // stable, for --effects lists and JSON
  bool used = false;
  std::uint64_t rays = 0;  // rays it concerns
  std::string reason;      // what calls for it, or why it was left out
  std::string stages;      // shader stages it needs
  std::string parts;       // simulator parts it needs
};

struct Effects {
  std::vector<EffectUse> uses;  // one per Effect, in its order
  bool used(Effect effect) const { return uses.at(static_cast<std::size_t>(effect)).used; }
};

Effects derive_effects(const Workload& workload);

}  // namespace a2rt
