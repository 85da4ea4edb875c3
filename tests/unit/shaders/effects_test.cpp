#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "a2rt/base/error.h"
#include "a2rt/workload/parts.h"
#include "effects/analysis.h"
#include "embedded/embedded.h"
#include "glsl/shared.h"
#include "scene/mesh_builder.h"

namespace a2rt::test {
namespace {

TEST(Effects, PartsAreThoseOfTheMachine) {
  std::set<std::string> known = {""};
  for (std::size_t i = 0; i < kPartCount; ++i) {
    known.insert(part_name(static_cast<Part>(i)));
  }
  for (const effects::Effect& effect : effects::all()) {
    EXPECT_TRUE(known.contains(effect.part)) << effect.name << ": " << effect.part;
  }
}

std::set<std::string> needed(const scene::Scene& s, const std::string& workload = "pt") {
  std::set<std::string> names;
  for (const effects::Call& call : effects::analyse(s, workloads::load(workload))) {
    if (call.needed()) {
      names.insert(call.effect.name);
    }
  }
  return names;
}

std::set<std::string> added(const std::set<std::string>& before,
                            const std::set<std::string>& after) {
  std::set<std::string> rest;
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::inserter(rest, rest.end()));
  return rest;
}

scene::Scene plain_quads() {
  scene::Scene s;
  s.name = "quads";
  for (const char* name : {"left", "right"}) {
    scene::Primitive p;
    p.material = add_material(s, scene::diffuse(name, glm::vec3(0.5F)));
    scene::add_quad(p, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    p.normals.clear();
    place(s, name, {p});
  }
  return s;
}

TEST(Effects, APlainSceneCallsForDiffuseLightOnly) {
  EXPECT_EQ(needed(plain_quads()), std::set<std::string>{"diffuse"});
}

TEST(Effects, TurningOneMaterialToGlassAddsExactlyRefraction) {
  scene::Scene s = plain_quads();
  const auto before = needed(s);
  s.materials[1] = scene::glass("pane", 1.5F);
  EXPECT_EQ(added(before, needed(s)), std::set<std::string>{"refraction"});
  EXPECT_TRUE(added(needed(s), before).empty());
}

TEST(Effects, ATextureThatLetsNothingThroughCallsForNoRefraction) {
  scene::Scene s = plain_quads();
  s.textures.push_back({});
  s.textures[0].rgba = {0, 255, 255, 255};
  scene::Material& m = s.materials[1];
  m.kind = scene::MaterialKind::kPrincipled;
  m.transmission = 1;
  EXPECT_TRUE(needed(s).contains("refraction"));
  m.transmission_texture = 0;
  EXPECT_EQ(added(needed(plain_quads()), needed(s)), std::set<std::string>{"textures"});
}

TEST(Effects, OnlySingleSidedSurfacesOfNoBodyCallForCulling) {
  scene::Scene s = plain_quads();
  s.materials[1].double_sided = false;
  EXPECT_EQ(added(needed(plain_quads()), needed(s)), std::set<std::string>{"culling"});
  s.materials[1] = scene::glass("pane", 1.5F);
  s.materials[1].double_sided = false;
  EXPECT_FALSE(needed(s).contains("culling")) << "the far wall of a glass body is seen from inside";
}

TEST(Effects, ANormalMapCallsForNormalMapsAlone) {
  scene::Scene s = plain_quads();
  s.textures.push_back({});
  s.materials[0].normal_texture = 0;
  EXPECT_EQ(added(needed(plain_quads()), needed(s)), std::set<std::string>{"normal-maps"});
}

TEST(Effects, RemovingTheLastMaskRemovesTheAnyHitPath) {
  scene::Scene s = embedded::make("forest");
  EXPECT_TRUE(needed(s).contains("alpha"));
  for (scene::Material& m : s.materials) {
    m.alpha_mode = scene::AlphaMode::kOpaque;
  }
  EXPECT_FALSE(needed(s).contains("alpha"));
  const auto choice = effects::choose(effects::analyse(s, workloads::load("pt")), "auto");
  EXPECT_FALSE(choice.has(gpu::kEffectAlpha));
}

TEST(Effects, AMaskThatNothingFallsBelowIsOpaque) {
  scene::Scene s = plain_quads();
  s.materials[0].alpha_mode = scene::AlphaMode::kMask;
  EXPECT_FALSE(needed(s).contains("alpha"));
  s.materials[0].alpha = 0.25F;
  EXPECT_TRUE(needed(s).contains("alpha"));
}

TEST(Effects, OnlySharedMeshesCallForInstancing) {
  scene::Scene s = plain_quads();
  s.instances[0].transform[3][0] = 5;
  EXPECT_FALSE(needed(s).contains("instancing")) << "a mesh drawn once is baked";
  s.instances.push_back(s.instances[0]);
  EXPECT_EQ(added(needed(plain_quads()), needed(s)), std::set<std::string>{"instancing"});
}

TEST(Effects, AMaterialNobodyUsesCallsForNothing) {
  scene::Scene s = plain_quads();
  add_material(s, scene::glass("unused", 1.5F));
  EXPECT_EQ(needed(s), needed(plain_quads()));
}

TEST(Effects, LightsCallForSharpOrSoftShadowsByTheirExtent) {
  scene::Scene s = plain_quads();
  s.lights.resize(1);
  EXPECT_EQ(added(needed(plain_quads()), needed(s)), std::set<std::string>{"shadow"});
  s.lights[0].radius = 0.1F;
  EXPECT_EQ(added(needed(plain_quads()), needed(s)), std::set<std::string>{"soft-shadow"});
}

TEST(Effects, TheWorkloadDecidesWhatOfTheSceneIsShown) {
  scene::Scene s = plain_quads();
  s.materials[1] = scene::glass("pane", 1.5F);
  EXPECT_EQ(needed(s, "ao"), std::set<std::string>{"ao"});
  EXPECT_EQ(needed(s, "sh"), std::set<std::string>{"shadow"});
}

TEST(Effects, AListRestrictsAndSaysWhatThePictureLacks) {
  const auto calls = effects::analyse(embedded::make("cornell"), workloads::load("ptl"));
  const auto choice = effects::choose(calls, "diffuse,emission,soft-shadow,normals");
  EXPECT_TRUE(choice.has(gpu::kEffectDiffuse));
  EXPECT_FALSE(choice.has(gpu::kEffectRefraction));
  EXPECT_THAT(choice.lacking, ::testing::UnorderedElementsAre("mirror", "rough", "refraction"));
  EXPECT_THROW(effects::choose(calls, "diffuse,magic"), UserError);
}

TEST(Effects, CopiesInsteadOfInstancesLackNothing) {
  const auto calls = effects::analyse(embedded::make("forest"), workloads::load("pt"));
  const auto choice = effects::choose(calls, "diffuse,soft-shadow,sky,alpha,textures,normals");
  EXPECT_FALSE(choice.has(gpu::kEffectInstancing));
  EXPECT_TRUE(choice.lacking.empty()) << choice.lacking.front();
}

TEST(Effects, EveryCallNamesWhoCallsAndAllContainsAuto) {
  for (const auto& description : embedded::all()) {
    const auto calls = effects::analyse(embedded::make(description.name), workloads::load("pt"));
    const auto automatic = effects::choose(calls, "auto");
    const auto everything = effects::choose(calls, "all");
    EXPECT_EQ(automatic.built & ~everything.built, 0U);
    EXPECT_NE(automatic.built, everything.built) << description.name << " needs all effects";
  }
}

}  // namespace
}  // namespace a2rt::test
