// Scenes whose exact picture is known.
#include <gtest/gtest.h>

#include <cmath>

#include "program.h"

namespace a2rt::test {
namespace {

class Furnace : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string reason = why_no_device();
    if (!reason.empty()) {
      GTEST_SKIP() << reason;
    }
  }
  // Mean of the first channel over the picture of a quad that fills the view, front to the camera.
  double mean(QuadFile quad, const std::string& arguments = "-w pt --spp 64") {
    quad.scene = R"({"nodes": [0], "extras": {"has_sky": true,
      "sky": {"bottom": [1, 1, 1], "top": [1, 1, 1]}}})";
    return mean_of(quad, arguments);
  }
  double mean_of(const QuadFile& quad, const std::string& arguments) {
    const auto file = folder_.write("quad.gltf", quad.text());
    const auto picture = folder_.path() / "quad.pfm";
    const Outcome run =
        run_program(file.string() + " --camera 0,0,1/0,0,0/20 --size 16x16 -q --hdr " +
                    picture.string() + " " + arguments);
    EXPECT_EQ(run.status, 0) << run.output;
    double sum = 0;
    const std::vector<float> rgb = read_pfm(picture);
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
      sum += rgb[i];
    }
    return sum / (static_cast<double>(rgb.size()) / 3);
  }
  TemporaryFolder folder_;
};

QuadFile of_material(const std::string& material) {
  QuadFile quad;
  quad.material = material;
  return quad;
}

TEST_F(Furnace, ALambertPlateUnderAWhiteSkyShowsItsAlbedo) {
  // One bounce to a sky of radiance 1 with a cosine-distributed direction: exactly the albedo.
  EXPECT_NEAR(mean({}), 0.5, 1e-5);
}

TEST_F(Furnace, AClearPaneAndAMirrorUnderAWhiteSkyAreInvisible) {
  EXPECT_NEAR(mean(of_material(R"({"doubleSided": true, "extras": {"kind": "glass"},
    "pbrMetallicRoughness": {"roughnessFactor": 0, "metallicFactor": 0},
    "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}})")),
              1, 1e-5);
  EXPECT_NEAR(mean(of_material(R"({"pbrMetallicRoughness": {"roughnessFactor": 0,
    "metallicFactor": 1}})")),
              1, 1e-5);
}

// Share of light that single scattering off GGX microfacets returns at normal incidence, by
// quadrature: tan^2 of the facet's angle is alpha^2 u / (1 - u) for uniform u, the weight is G1 of
// the reflected direction, and what goes below the surface is lost.
double ggx_albedo(double roughness) {
  const double alpha2 = std::pow(roughness, 4);
  constexpr int kSteps = 100000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double u = (i + 0.5) / kSteps;
    const double tan2 = alpha2 * u / (1 - u);
    const double cosine = (1 - tan2) / (1 + tan2);
    if (cosine > 0) {
      sum += 2 * cosine / (cosine + std::sqrt(alpha2 + (1 - alpha2) * cosine * cosine));
    }
  }
  return sum / kSteps;
}

TEST_F(Furnace, RoughMetalReturnsWhatSingleScatteringPredicts) {
  for (const double roughness : {0.2, 0.5, 0.9}) {
    const double value =
        mean(of_material(R"({"pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": )" +
                         std::to_string(roughness) + "}}"));
    EXPECT_NEAR(value, ggx_albedo(roughness), 0.02) << roughness;
  }
}

TEST_F(Furnace, AHalfCoveringPlateShowsHalfSkyHalfPaint) {
  const double value = mean(of_material(R"({"alphaMode": "BLEND", "pbrMetallicRoughness": {
    "baseColorFactor": [0, 0, 0, 0.5], "metallicFactor": 0, "roughnessFactor": 1}})"));
  // 16x16x64 coin flips: standard error 0.004.
  EXPECT_NEAR(value, 0.5, 0.016);
}

TEST_F(Furnace, ADirectionalLightGivesLambertsLaw) {
  QuadFile quad;
  quad.extra = R"("extensionsUsed": ["KHR_lights_punctual"], "extensions": {
    "KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 3.14159265}]}},)";
  // 60 degrees from the normal (rotation about x by -60 degrees: half angle 30).
  quad.nodes = R"([{"mesh": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}},
    "rotation": [-0.5, 0, 0, 0.8660254]}])";
  quad.scene = R"({"nodes": [0, 1]})";
  EXPECT_NEAR(mean_of(quad, "-w pt --spp 4"), 0.5 * 0.5, 1e-4);
}

// The light comes from 60 degrees above the normal; the texel turns the normal up by 45 degrees.
TEST_F(Furnace, ANormalMapTurnsTheNormalTowardsTheTopOfTheTexture) {
  QuadFile quad;
  quad.attributes = {QuadFile::picture_coordinates()};
  quad.extra =
      R"("images": [{"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAAD)"
      R"(UlEQVR42mNouHXrPwAHRgM0H1NcegAAAABJRU5ErkJggg=="}], "textures": [{"source": 0}],)"
      R"("extensionsUsed": ["KHR_lights_punctual"], "extensions": {
    "KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 3.14159265}]}},)";
  quad.scene = R"({"nodes": [0, 1]})";
  const std::string sun = R"({"extensions": {"KHR_lights_punctual": {"light": 0}},
    "rotation": [-0.5, 0, 0, 0.8660254]}])";
  const auto shade = [&](const std::string& scale, const std::string& node) {
    quad.material = R"({"normalTexture": {"index": 0, "scale": )" + scale + R"(},
      "doubleSided": true, "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1],
      "metallicFactor": 0, "roughnessFactor": 1}})";
    quad.nodes = R"([{"mesh": 0)" + node + "}, " + sun;
    return mean_of(quad, "-w pt --spp 1");
  };
  const double degree = 3.14159265358979 / 180;
  EXPECT_NEAR(shade("1", ""), 0.5 * std::cos(15 * degree), 1e-3);
  EXPECT_NEAR(shade("0", ""), 0.5 * std::cos(60 * degree), 1e-3);
  EXPECT_NEAR(shade("1", R"(, "scale": [-1, 1, 1])"), 0.5 * std::cos(15 * degree), 1e-3)
      << "a mirror image has its texture's top where the original has it";
  EXPECT_NEAR(shade("1", R"(, "rotation": [0, 0, 1, 0])"), 0, 1e-3)
      << "upside down the normal turns away from the light";
}

TEST_F(Furnace, ASingleSidedPlateIsSeenFromItsFrontOnly) {
  const auto brightness = [&](const std::string& node, bool twice) {
    QuadFile quad;
    // Drawn twice, a mesh stays an instance; once, it is baked into the world.
    quad.nodes = R"([{"children": [1)" + std::string(twice ? ", 2" : "") + R"(]}, {"mesh": 0)" +
                 node + R"(}, {"mesh": 0, "translation": [90, 0, 0]}])";
    return mean(quad, "-w pt --spp 1");
  };
  for (const bool twice : {false, true}) {
    EXPECT_NEAR(brightness("", twice), 0.5, 1e-5);
    EXPECT_NEAR(brightness(R"(, "rotation": [0, 1, 0, 0])", twice), 1, 1e-5) << "the sky behind";
    EXPECT_NEAR(brightness(R"(, "scale": [-1, 1, 1])", twice), 0.5, 1e-5) << "mirrored, same side";
    EXPECT_NEAR(brightness(R"(, "scale": [1, 1, -1])", twice), 1, 1e-5) << "mirrored to the back";
  }
}

TEST_F(Furnace, AThinSheetOfGlassDoesNotBendLight) {
  // A plate at 45 degrees before a sky that grows bright upwards. 5 % of the light is reflected;
  // the rest goes straight on to the horizon, or, into a body, by 17 degrees up or down.
  const auto brightness = [&](const std::string& volume) {
    QuadFile quad;
    quad.scene = R"({"nodes": [0], "extras": {"has_sky": true,
      "sky": {"bottom": [0, 0, 0], "top": [1, 1, 1]}}})";
    quad.nodes = R"([{"mesh": 0, "rotation": [0.38268343, 0, 0, 0.92387953]}])";
    quad.material = R"({"doubleSided": true, "pbrMetallicRoughness": {"roughnessFactor": 0,
      "metallicFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1})" +
                    volume + "}}";
    return mean_of(quad, "-w pt --spp 4");
  };
  EXPECT_NEAR(brightness(""), 0.5, 0.04);
  EXPECT_GT(std::abs(brightness(R"(, "KHR_materials_volume": {"thicknessFactor": 1})") - 0.5),
            0.08);
}

TEST_F(Furnace, LightSamplingAndPlainPathsAgreeOnTheCornellBox) {
  const auto brightness = [&](const std::string& workload) {
    const auto picture = folder_.path() / "cornell.pfm";
    // The floor before the blocks, lit by the lamp and the walls; no caustics get there.
    const Outcome run =
        run_program("cornell -q --size 12x6 --spp 192 --max-bounces 4 --clamp-indirect 0 -w " +
                    workload + " --camera 2.75,2.2,5.4/0.7,0,5.0/16 --hdr " + picture.string());
    EXPECT_EQ(run.status, 0) << run.output;
    double sum = 0;
    const std::vector<float> rgb = read_pfm(picture);
    for (const float value : rgb) {
      sum += value;
    }
    return sum / static_cast<double>(rgb.size());
  };
  const double sampled = brightness("ptl");
  EXPECT_NEAR(brightness("pt") / sampled, 1, 0.08);
}

}  // namespace
}  // namespace a2rt::test
