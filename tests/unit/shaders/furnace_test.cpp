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

TEST_F(Furnace, LightSamplingAndPlainPathsAgreeOnTheCornellBox) {
  const auto brightness = [&](const std::string& workload) {
    const auto picture = folder_.path() / "cornell.pfm";
    // The floor before the blocks, lit by the lamp and the walls; no caustics get there.
    const Outcome run =
        run_program("cornell -q --size 12x6 --spp 192 --max-bounces 4 -w " + workload +
                    " --camera 2.75,2.2,5.4/0.7,0,5.0/16 --hdr " + picture.string());
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
