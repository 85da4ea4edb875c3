// Embree's own traversal of a workload's geometry: the speed limit that units are measured against.
#pragma once

#include <cstdint>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt::tools {

// TLAS 0 of a workload as an Embree scene (robust, medium quality, one thread). Procedural
// geometry and any-hit shaders are left out: Embree is only timed, not compared.
class EmbreeScene {
 public:
  explicit EmbreeScene(const Workload& workload);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  // Closest hit by rtcIntersect1; true if there is one.
  bool trace(const Ray& ray) const;

 private:
  struct Handles;
  Handles* handles_;
};

}  // namespace a2rt::tools
