#include "random_workload.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "a2rt/workload/synthetic.h"

namespace a2rt::testing {
namespace {

using synthetic::Random;

float any_float(Random& random) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
}
Vec3 any_vec3(Random& random) { return {any_float(random), any_float(random), any_float(random)}; }
std::vector<std::byte> any_bytes(Random& random) {
  std::vector<std::byte> bytes(random.below(200));
  for (auto& b : bytes) {
    b = static_cast<std::byte>(random.bits());
  }
  return bytes;
}

Blas any_blas(Random& random) {
  Blas blas;
  const bool procedural = random.below(3) == 0;
  const std::uint32_t geometries = random.below(4);
  for (std::uint32_t g = 0; g < geometries; ++g) {
    const std::uint32_t count = random.below(6);
    blas.geometries.push_back({blas.primitive_count(), count, random.below(2) == 1});
    for (std::uint32_t p = 0; p < count; ++p) {
      if (procedural) {
        blas.aabbs.push_back({any_vec3(random), any_vec3(random)});
      } else {
        blas.triangles.push_back({{any_vec3(random), any_vec3(random), any_vec3(random)}});
      }
    }
  }
  blas.driver_nodes = any_bytes(random);
  return blas;
}

Affine any_map(Random& random) {
  Affine map;
  for (auto& row : map.m) {
    for (float& value : row) {
      value = any_float(random);
    }
  }
  return map;
}

Tlas any_tlas(Random& random, std::uint32_t blas_count) {
  Tlas tlas;
  const std::uint32_t count = random.below(5);
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool active = blas_count > 0 && random.below(4) != 0;
    tlas.instances.push_back({any_map(random), any_map(random),
                              active ? random.below(blas_count) : kNone, random.below(1u << 24),
                              random.below(256), random.below(1u << 24), random.below(16)});
  }
  tlas.driver_nodes = any_bytes(random);
  return tlas;
}

// A primitive that a ray of this TLAS could have met; false if it has none.
bool any_primitive(const Workload& w, std::uint32_t tlas, Random& random, std::uint32_t& instance,
                   std::uint32_t& geometry, std::uint32_t& primitive) {
  const auto& instances = w.tlas[tlas].instances;
  if (instances.empty()) {
    return false;
  }
  instance = random.below(static_cast<std::uint32_t>(instances.size()));
  if (instances[instance].blas == kNone || w.blas[instances[instance].blas].geometries.empty()) {
    return false;
  }
  const auto& geometries = w.blas[instances[instance].blas].geometries;
  geometry = random.below(static_cast<std::uint32_t>(geometries.size()));
  if (geometries[geometry].count == 0) {
    return false;
  }
  primitive = random.below(geometries[geometry].count);
  return true;
}

void any_ray(Workload& w, std::uint32_t dispatch, std::uint32_t launch, Random& random) {
  const auto index = static_cast<std::uint32_t>(w.rays.size());
  Ray ray{any_vec3(random), any_float(random), any_vec3(random), any_float(random)};
  ray.flags = random.below(0x400);
  ray.mask = random.below(256);
  ray.tlas = random.below(static_cast<std::uint32_t>(w.tlas.size()));
  ray.sbt = random.below(1u << 24);
  ray.dispatch = dispatch;
  ray.launch = launch;
  ray.parent = index > 0 && random.below(2) == 0 ? random.below(index) : kNone;
  w.rays.push_back(ray);
  Hit hit;
  hit.t = any_float(random);
  if (any_primitive(w, ray.tlas, random, hit.instance, hit.geometry, hit.primitive)) {
    hit.state = static_cast<HitState>(random.below(4));
  }
  w.driver_hits.push_back(hit);
  for (std::uint32_t c = random.below(3); c > 0; --c) {
    Candidate candidate;
    candidate.t = any_float(random);
    if (any_primitive(w, ray.tlas, random, candidate.instance, candidate.geometry,
                      candidate.primitive)) {
      w.candidates.push_back(candidate);
    }
  }
  w.candidate_first.push_back(w.candidates.size());
}

void any_dispatch(Workload& w, Random& random) {
  const auto index = static_cast<std::uint32_t>(w.dispatches.size());
  Dispatch d{index,
             1 + random.below(4),
             1 + random.below(4),
             1 + random.below(2),
             w.rays.size(),
             0,
             w.segments.size(),
             0};
  for (std::uint32_t launch = 0; launch < d.width * d.height * d.depth; ++launch) {
    for (std::uint32_t r = w.tlas.empty() ? 0 : random.below(4); r > 0; --r) {
      any_ray(w, index, launch, random);
      if (!w.shaders.empty()) {
        Segment segment{launch, random.below(static_cast<std::uint32_t>(w.shaders.size()))};
        segment.counts[random.below(8)] = static_cast<std::uint32_t>(random.bits());
        segment.ray = random.below(2) == 0 ? kNone : static_cast<std::uint32_t>(w.rays.size() - 1);
        w.segments.push_back(segment);
      }
    }
  }
  d.ray_count = w.rays.size() - d.first_ray;
  d.segment_count = w.segments.size() - d.first_segment;
  w.dispatches.push_back(d);
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_blas(const Blas& a, const Blas& b) {
  return same(a.triangles, b.triangles) && same(a.aabbs, b.aabbs) &&
         a.driver_nodes == b.driver_nodes &&
         std::equal(a.geometries.begin(), a.geometries.end(), b.geometries.begin(),
                    b.geometries.end(), [](const Geometry& x, const Geometry& y) {
                      return x.first == y.first && x.count == y.count && x.opaque == y.opaque;
                    });
}

bool same_shaders(const std::vector<Shader>& a, const std::vector<Shader>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Shader& x, const Shader& y) {
    return x.stage == y.stage && x.hash == y.hash && x.entry == y.entry;
  });
}

bool same_provenance(const Provenance& a, const Provenance& b) {
  return a.program == b.program && a.driver == b.driver && a.command_line == b.command_line &&
         a.scene == b.scene && a.workload == b.workload && a.refused == b.refused &&
         a.tree_rebuilt == b.tree_rebuilt;
}

}  // namespace

Workload random_workload(std::uint64_t seed) {
  Random random(seed);
  Workload w;
  w.provenance = {"prógram", "", "a b c", "scene", "pt", "nothing", random.below(2) == 1};
  for (std::uint32_t n = random.below(4); n > 0; --n) {
    w.blas.push_back(any_blas(random));
  }
  for (std::uint32_t n = random.below(3); n > 0; --n) {
    w.tlas.push_back(any_tlas(random, static_cast<std::uint32_t>(w.blas.size())));
  }
  for (std::uint32_t n = random.below(3); n > 0; --n) {
    w.shaders.push_back({random.below(9), random.bits(), n == 1 ? "" : "main"});
  }
  w.candidate_first.push_back(0);
  for (std::uint32_t n = random.below(3); n > 0; --n) {
    any_dispatch(w, random);
  }
  return w;
}

bool same_bits(const Workload& a, const Workload& b) {
  return same_provenance(a.provenance, b.provenance) &&
         std::equal(a.blas.begin(), a.blas.end(), b.blas.begin(), b.blas.end(), same_blas) &&
         std::equal(a.tlas.begin(), a.tlas.end(), b.tlas.begin(), b.tlas.end(),
                    [](const Tlas& x, const Tlas& y) {
                      return same(x.instances, y.instances) && x.driver_nodes == y.driver_nodes;
                    }) &&
         same(a.dispatches, b.dispatches) && same_shaders(a.shaders, b.shaders) &&
         same(a.rays, b.rays) && same(a.driver_hits, b.driver_hits) &&
         a.candidate_first == b.candidate_first && same(a.candidates, b.candidates) &&
         same(a.segments, b.segments);
}

}  // namespace a2rt::testing
