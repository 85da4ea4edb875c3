#include "embedded/embedded.h"

#include <gtest/gtest.h>

#include "gltf/exporter.h"
#include "gltf/loader.h"
#include "gltf_file.h"
#include "workloads/workload_config.h"

namespace a2rt::test {
namespace {

class Embedded : public ::testing::TestWithParam<std::string> {};

TEST_P(Embedded, IsValidAndTheSameEveryTime) {
  const scene::Scene a = embedded::make(GetParam());
  const scene::Scene b = embedded::make(GetParam());
  EXPECT_NO_THROW(scene::validate(a));
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    for (std::size_t p = 0; p < a.meshes[m].primitives.size(); ++p) {
      ASSERT_EQ(a.meshes[m].primitives[p].positions, b.meshes[m].primitives[p].positions);
    }
  }
}

TEST_P(Embedded, SurvivesTheWayThroughAFile) {
  const TemporaryFolder folder;
  const scene::Scene a = embedded::make(GetParam());
  gltf::save(a, folder.path() / "scene.glb");
  const scene::Scene b = gltf::load(folder.path() / "scene.glb");
  const scene::Counts ca = scene::count(a);
  const scene::Counts cb = scene::count(b);
  EXPECT_EQ(ca.triangles, cb.triangles);
  EXPECT_EQ(ca.drawn_triangles, cb.drawn_triangles);
  EXPECT_EQ(ca.shapes, cb.shapes);
  EXPECT_EQ(ca.instances, cb.instances);
  EXPECT_EQ(a.textures.size(), b.textures.size());
  EXPECT_EQ(a.cameras.size(), b.cameras.size());
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_NEAR(a.lights[i].direction.y, b.lights[i].direction.y, 1e-5);
    EXPECT_NEAR(a.lights[i].radius, b.lights[i].radius, 1e-6);
  }
  EXPECT_TRUE(b.warnings.empty()) << b.warnings.front();
}

// Whatever registered itself: a new scene is tested without an edit here.
std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const embedded::Description& one : embedded::all()) {
    all.push_back(one.name);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Embedded, ::testing::ValuesIn(names()),
                         [](const auto& test) { return test.param; });

TEST(Spheres, HasTheFieldOfTheBook) {
  const scene::Counts c = scene::count(embedded::make("spheres"));
  EXPECT_GE(c.shapes, 470U);
  EXPECT_LE(c.shapes, 488U);
  EXPECT_EQ(c.triangles, 0U);
}

TEST(Workloads, AllConfigurationsAreReadable) {
  EXPECT_GE(workloads::names().size(), 8U);
  for (const std::string& name : workloads::names()) {
    const workloads::WorkloadConfig w = workloads::load(name);
    EXPECT_FALSE(w.effects.empty()) << name;
    EXPECT_FALSE(w.rays.empty()) << name;
  }
}

}  // namespace
}  // namespace a2rt::test
