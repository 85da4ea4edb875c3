#include "gltf/loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gltf/exporter.h"
#include "gltf_file.h"

namespace a2rt::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A picture of one black, opaque pixel.
const std::string kBlackPixel =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNgYGD4DwABBAEAgLvRWwAAAABJRU5ErkJggg"
    "==";

scene::Scene load(const QuadFile& file, const TemporaryFolder& folder) {
  return gltf::load(folder.write("quad.gltf", file.text()));
}

TEST(Loader, ReadsAQuadAsTwoTriangles) {
  const TemporaryFolder folder;
  const scene::Scene s = load({}, folder);
  ASSERT_EQ(s.meshes.size(), 1U);
  EXPECT_THAT(s.meshes[0].primitives[0].indices, ElementsAre(0, 1, 2, 0, 2, 3));
  EXPECT_EQ(s.meshes[0].primitives[0].positions[2], glm::vec3(1, 1, 0));
  EXPECT_EQ(s.materials[0].kind, scene::MaterialKind::kDiffuse);
  EXPECT_TRUE(s.sky.present) << "nothing else lights this file";
}

TEST(Loader, NodeTransformsMultiplyDownTheTreeAndKeepNegativeScale) {
  const TemporaryFolder folder;
  QuadFile file;
  file.nodes = R"([{"children": [1], "translation": [10, 0, 0]},
                   {"mesh": 0, "scale": [-2, 1, 1]}])";
  const scene::Scene s = load(file, folder);
  ASSERT_EQ(s.instances.size(), 1U);
  EXPECT_EQ(s.instances[0].transform[0][0], -2);
  EXPECT_EQ(s.instances[0].transform[3][0], 10);
  const scene::Bounds bounds = scene::world_bounds(s);
  EXPECT_EQ(bounds.lo.x, 8);
  EXPECT_EQ(bounds.hi.x, 12);
}

TEST(Loader, AMeshOfTwoNodesIsStoredOnce) {
  const TemporaryFolder folder;
  QuadFile file;
  file.nodes = R"([{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 1]}])";
  file.scene = R"({"nodes": [0, 1]})";
  const scene::Scene s = load(file, folder);
  EXPECT_EQ(s.meshes.size(), 1U);
  EXPECT_EQ(s.instances.size(), 2U);
  EXPECT_EQ(scene::count(s).drawn_triangles, 4U);
}

TEST(Loader, ReadsThePhysicalMaterialExtensions) {
  const TemporaryFolder folder;
  QuadFile file;
  file.extra = R"("extensionsUsed": ["KHR_materials_transmission", "KHR_materials_ior",
    "KHR_materials_volume", "KHR_materials_emissive_strength", "KHR_materials_clearcoat"],)";
  file.material = R"({"emissiveFactor": [1, 0.5, 0], "extensions": {
    "KHR_materials_transmission": {"transmissionFactor": 0.75},
    "KHR_materials_ior": {"ior": 1.25},
    "KHR_materials_volume": {"attenuationDistance": 2, "attenuationColor": [0.5, 1, 1]},
    "KHR_materials_emissive_strength": {"emissiveStrength": 4},
    "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25}}})";
  const scene::Scene s = load(file, folder);
  const scene::Material& m = s.materials[0];
  EXPECT_EQ(m.transmission, 0.75F);
  EXPECT_EQ(m.ior, 1.25F);
  EXPECT_EQ(m.attenuation_distance, 2);
  EXPECT_EQ(m.attenuation_color, glm::vec3(0.5F, 1, 1));
  EXPECT_EQ(m.emission, glm::vec3(4, 2, 0));
  EXPECT_EQ(m.clearcoat, 0.5F);
  EXPECT_EQ(m.clearcoat_roughness, 0.25F);
  EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
}

TEST(Loader, TransmissionBoundsABodyOnlyIfTheMaterialHasThickness) {
  const TemporaryFolder folder;
  QuadFile file;
  file.extra = R"("extensionsUsed": ["KHR_materials_transmission", "KHR_materials_volume"],)";
  for (const auto& [volume, thin] :
       {std::pair("", true), std::pair(R"(, "KHR_materials_volume": {})", true),
        std::pair(R"(, "KHR_materials_volume": {"thicknessFactor": 0.1})", false)}) {
    file.material = std::string(R"({"extensions": {"KHR_materials_transmission":
      {"transmissionFactor": 1})") +
                    volume + "}}";
    const scene::Scene s = load(file, folder);
    EXPECT_EQ(s.materials[0].thin, thin) << volume;
    gltf::save(s, folder.path() / "again.glb");
    EXPECT_EQ(gltf::load(folder.path() / "again.glb").materials[0].thin, thin) << volume;
  }
}

TEST(Loader, ReadsEveryTextureThatTheShadersApply) {
  const TemporaryFolder folder;
  QuadFile file;
  file.attributes = {QuadFile::picture_coordinates()};
  file.extra = R"("extensionsUsed": ["KHR_materials_transmission", "KHR_materials_clearcoat"],
    "images": [{"uri": "data:image/png;base64,)" +
               kBlackPixel + R"("}],
    "textures": [{"source": 0}],)";
  file.material = R"({"normalTexture": {"index": 0, "scale": 0.5}, "emissiveFactor": [1, 1, 1],
    "emissiveTexture": {"index": 0}, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
    "metallicRoughnessTexture": {"index": 0}}, "extensions": {
    "KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": 0}},
    "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatTexture": {"index": 0},
    "clearcoatRoughnessTexture": {"index": 0}}}})";
  const scene::Scene s = load(file, folder);
  const scene::Material& m = s.materials[0];
  for (const std::uint32_t texture :
       {m.base_texture, m.metallic_roughness_texture, m.emissive_texture, m.normal_texture,
        m.transmission_texture, m.clearcoat_texture, m.clearcoat_roughness_texture}) {
    EXPECT_LT(texture, s.textures.size());
  }
  EXPECT_FALSE(s.textures[m.normal_texture].srgb);
  EXPECT_EQ(m.normal_scale, 0.5F);
  EXPECT_TRUE(s.warnings.empty()) << s.warnings.front();
}

TEST(Loader, ReadsAlphaModesAndSides) {
  const TemporaryFolder folder;
  QuadFile file;
  EXPECT_FALSE(load(file, folder).materials[0].double_sided);
  file.material = R"({"alphaMode": "MASK", "alphaCutoff": 0.75, "doubleSided": true})";
  scene::Scene s = load(file, folder);
  EXPECT_EQ(s.materials[0].alpha_mode, scene::AlphaMode::kMask);
  EXPECT_EQ(s.materials[0].alpha_cutoff, 0.75F);
  EXPECT_TRUE(s.materials[0].double_sided);
  file.material = R"({"alphaMode": "BLEND", "pbrMetallicRoughness": {
    "baseColorFactor": [1, 1, 1, 0.25]}})";
  s = load(file, folder);
  EXPECT_EQ(s.materials[0].alpha_mode, scene::AlphaMode::kBlend);
  EXPECT_EQ(s.materials[0].alpha, 0.25F);
}

TEST(Loader, PlacesOneInstancePerRowOfTheInstancingExtension) {
  const TemporaryFolder folder;
  QuadFile file;
  file.extra = R"("extensionsUsed": ["EXT_mesh_gpu_instancing"],
    "extensionsRequired": ["EXT_mesh_gpu_instancing"],)";
  // The quad's own corners serve as translations.
  file.nodes = R"([{"mesh": 0, "scale": [3, 3, 3], "extensions": {"EXT_mesh_gpu_instancing": {
    "attributes": {"TRANSLATION": 0}}}}])";
  const scene::Scene s = load(file, folder);
  ASSERT_EQ(s.instances.size(), 4U);
  EXPECT_EQ(s.meshes.size(), 1U);
  EXPECT_EQ(s.instances[2].transform[3][0], 3) << "instances are placed inside their node";
  EXPECT_EQ(scene::world_bounds(s).hi.x, 6);
}

TEST(Loader, ASkinIsDrawnAtItsRestPoseAndItsNodeDoesNotCount) {
  const TemporaryFolder folder;
  QuadFile file;
  file.attributes = {{"JOINTS_0", "VEC4", std::vector<float>(16, 0)},
                     {"WEIGHTS_0", "VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}}};
  file.extra = R"("skins": [{"joints": [1]}],)";
  file.nodes = R"([{"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
                   {"translation": [0, 5, 0]}])";
  file.scene = R"({"nodes": [0, 1]})";
  const scene::Bounds bounds = scene::world_bounds(load(file, folder));
  EXPECT_EQ(bounds.lo, glm::vec3(-1, 4, 0));
  EXPECT_EQ(bounds.hi, glm::vec3(1, 6, 0));
}

TEST(Loader, AnOptionalUnknownExtensionIsOneWarning) {
  const TemporaryFolder folder;
  QuadFile file;
  file.extra = R"("extensionsUsed": ["EXT_nobody_knows"],)";
  const scene::Scene s = load(file, folder);
  ASSERT_EQ(s.warnings.size(), 1U);
  EXPECT_THAT(s.warnings[0], HasSubstr("EXT_nobody_knows"));
}

TEST(Loader, AMissingImageIsOneWarningAndTheGeometryStays) {
  const TemporaryFolder folder;
  QuadFile file;
  file.extra = R"("images": [{"uri": "absent.png"}], "textures": [{"source": 0}],)";
  file.material = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})";
  const scene::Scene s = load(file, folder);
  ASSERT_EQ(s.warnings.size(), 1U);
  EXPECT_THAT(s.warnings[0], HasSubstr("absent.png"));
  EXPECT_EQ(scene::count(s).triangles, 2U);
}

TEST(Loader, LightsPointTheWayOfTheirNodes) {
  const TemporaryFolder folder;
  QuadFile file;
  file.extra = R"("extensionsUsed": ["KHR_lights_punctual"], "extensions": {
    "KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 2}]}},)";
  file.nodes = R"([{"mesh": 0}, {"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 0}},
    "rotation": [-0.70710678, 0, 0, 0.70710678]}])";
  file.scene = R"({"nodes": [0, 1]})";
  const scene::Scene s = load(file, folder);
  ASSERT_EQ(s.lights.size(), 1U);
  EXPECT_NEAR(s.lights[0].direction.y, 1, 1e-6);  // -z turned down: the light comes from above
  EXPECT_EQ(s.lights[0].color, glm::vec3(2));
  EXPECT_FALSE(s.sky.present) << "the file has a light of its own";
}

TEST(Loader, VerticesWithXNanMakeTheirTrianglesInactive) {
  const TemporaryFolder folder;
  QuadFile file;
  // Through a sparse-free trick: the fourth vertex carries the NaN, the first triangle lives on.
  file.positions[9] = std::numeric_limits<float>::quiet_NaN();
  const scene::Scene s = load(file, folder);
  EXPECT_EQ(s.inactive_triangles, 1U);
  EXPECT_EQ(scene::count(s).triangles, 1U);
}

TEST(Loader, AnExportedSceneComesBackTheSame) {
  const TemporaryFolder folder;
  QuadFile file;
  file.nodes = R"([{"mesh": 0}, {"mesh": 0, "scale": [1, -3, 1]}])";
  file.scene = R"({"nodes": [0, 1]})";
  const scene::Scene s = load(file, folder);
  gltf::save(s, folder.path() / "again.glb");
  const scene::Scene again = gltf::load(folder.path() / "again.glb");
  EXPECT_EQ(again.meshes[0].primitives[0].positions, s.meshes[0].primitives[0].positions);
  EXPECT_EQ(again.meshes[0].primitives[0].indices, s.meshes[0].primitives[0].indices);
  ASSERT_EQ(again.instances.size(), 2U);
  EXPECT_EQ(again.instances[1].transform, s.instances[1].transform);
  EXPECT_EQ(again.materials[0].base_color, s.materials[0].base_color);
  EXPECT_EQ(again.sky.present, s.sky.present);
}

}  // namespace
}  // namespace a2rt::test
