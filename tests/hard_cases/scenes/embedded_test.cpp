// The embedded scenes' own geometry, with rays aimed exactly at vertices and edges.
#include "embedded/embedded.h"

#include <gtest/gtest.h>

#include <string>

#include "a2rt/hard/watertight.h"
#include "a2rt/workload/synthetic.h"

namespace a2rt::hard {
namespace {

Vec3 to_vec(const glm::vec3& v) { return {v.x, v.y, v.z}; }

Blas blas_of(const scene::Mesh& mesh) {
  Blas blas;
  for (const scene::Primitive& p : mesh.primitives) {
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
      blas.triangles.push_back(
          {{to_vec(p.positions[p.indices[i]]), to_vec(p.positions[p.indices[i + 1]]),
            to_vec(p.positions[p.indices[i + 2]])}});
    }
  }
  blas.geometries.push_back({0, static_cast<std::uint32_t>(blas.triangles.size()), true});
  return blas;
}

Blas blas_of(const scene::ShapeSet& set) {
  Blas blas;
  for (const scene::Shape& s : set.shapes) {
    const bool sphere = set.kind == scene::ShapeKind::kSphere;
    const glm::vec3 half = sphere ? glm::vec3(s.half_extent.x) : s.half_extent;
    blas.aabbs.push_back({to_vec(s.centre - half), to_vec(s.centre + half)});
  }
  blas.geometries.push_back({0, static_cast<std::uint32_t>(blas.aabbs.size()), true});
  return blas;
}

Affine to_affine(const glm::dmat4& m) {
  Affine out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      out.m[r][c] = static_cast<float>(m[c][r]);
    }
  }
  return out;
}

// Structures and instances of an embedded scene, and rays from points around its camera.
Workload workload_of(const std::string& name) {
  const scene::Scene scene = embedded::make(name);
  Workload w;
  for (const scene::Mesh& mesh : scene.meshes) {
    w.blas.push_back(blas_of(mesh));
  }
  for (const scene::ShapeSet& set : scene.shape_sets) {
    w.blas.push_back(blas_of(set));
  }
  w.tlas.resize(1);
  for (const scene::Instance& i : scene.instances) {
    Instance instance;
    instance.object_to_world = to_affine(i.transform);
    instance.world_to_object = to_affine(glm::inverse(i.transform));
    instance.blas = i.mesh != scene::kNoIndex
                        ? i.mesh
                        : static_cast<std::uint32_t>(scene.meshes.size()) + i.shape_set;
    w.tlas[0].instances.push_back(instance);
  }
  const glm::vec3 eye = scene.cameras.empty() ? world_bounds(scene).centre() : scene.cameras[0].eye;
  synthetic::Random random(5);
  for (int i = 0; i < 50; ++i) {
    Ray ray;
    const Vec3 off = random.in_box(-0.01F, 0.01F);
    ray.origin = {eye.x + off.x, eye.y + off.y, eye.z + off.z};
    w.rays.push_back(ray);
  }
  return w;
}

class EmbeddedSceneTest : public testing::TestWithParam<std::string> {};

TEST_P(EmbeddedSceneTest, NoRayLeaksThroughVerticesAndEdgesForUnitsThatNeverMiss) {
  const bool procedural_only = embedded::make(GetParam()).meshes.empty();
  const Workload aimed = aim_at_edges(workload_of(GetParam()), 500, 9);
  ASSERT_EQ(aimed.rays.size(), 500U);
  const std::vector<Hit> truth = true_hits(aimed);
  for (const UnitColumn& column : unit_columns()) {
    if (make_unit(column)->info().promise == Promise::kMayMiss) {
      continue;
    }
    const Leaks leaks = count_leaks(column, aimed, truth);
    EXPECT_EQ(leaks.leaked, 0U) << column.key;
    EXPECT_EQ(leaks.farther, 0U) << column.key;
    EXPECT_EQ(leaks.missed, 0U) << column.key;
    // Procedural shapes are hit by shaders; there, the box decisions are the whole claim.
    EXPECT_TRUE(procedural_only || leaks.hits > 200) << column.key << ": " << leaks.hits;
  }
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const embedded::Description& one : embedded::all()) {
    all.push_back(one.name);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, EmbeddedSceneTest, testing::ValuesIn(names()),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace a2rt::hard
