// Pictures on the stock driver: the same from the same seed, whatever else is varied.
#include <gtest/gtest.h>

#include "embedded/embedded.h"
#include "program.h"
#include "workloads/workload_config.h"

namespace a2rt::test {
namespace {

class Picture : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string reason = why_no_device();
    if (!reason.empty()) {
      GTEST_SKIP() << reason;
    }
  }
  // Bytes of the float picture; fails the test if the program does.
  std::string draw(const std::string& arguments, const std::string& environment = "") {
    const auto file = folder_.path() / "picture.pfm";
    const Outcome run = run_program(arguments + " -q --hdr " + file.string(), environment);
    EXPECT_EQ(run.status, 0) << arguments << ": " << run.output;
    const std::string bytes = read_bytes(file);
    EXPECT_FALSE(bytes.empty()) << arguments;
    std::filesystem::remove(file);
    return bytes;
  }
  TemporaryFolder folder_;
};

const std::string kSmall = " --size 16x10 --spp 1";

TEST_F(Picture, DependsOnTheSeedAndNotOnTheNumberOfThreads) {
  const std::string one = draw("cornell" + kSmall, "LP_NUM_THREADS=0");
  EXPECT_EQ(one, draw("cornell" + kSmall, "LP_NUM_THREADS=2"));
  EXPECT_NE(one, draw("cornell" + kSmall + " --seed 2"));
}

TEST_F(Picture, DoesNotDependOnHowAFrameIsCutIntoDispatches) {
  const std::string arguments = "cornell --size 16x16 --spp 5 -w pt";
  const std::string whole = draw(arguments);
  EXPECT_EQ(whole, draw(arguments + " --samples-per-dispatch 2"));
  EXPECT_EQ(whole, draw("cornell --size 16x16 --spp 1 --frames 5 -w pt"));
}

TEST_F(Picture, AutoAndAllEffectsDrawTheSameBytes) {
  for (const embedded::Description& scene : embedded::all()) {
    const std::string arguments = scene.name + kSmall;
    EXPECT_EQ(draw(arguments), draw(arguments + " --effects all")) << scene.name;
  }
}

TEST_F(Picture, EveryWorkloadDrawsAndNoneBlack) {
  for (const std::string& workload : workloads::names()) {
    const auto file = folder_.path() / "w.pfm";
    const Outcome run =
        run_program("cornell --size 12x12 --spp 1 -q -w " + workload + " --hdr " + file.string());
    ASSERT_EQ(run.status, 0) << run.output;
    double sum = 0;
    for (const float value : read_pfm(file)) {
      ASSERT_TRUE(value >= 0 && value < 1e4F) << workload;
      sum += value;
    }
    EXPECT_GT(sum, 1) << workload;
  }
}

TEST_F(Picture, ShadowsAreTheSameWithAndWithoutTheClosestHitShader) {
  for (const char* workload : {"sh", "ao"}) {
    const std::string arguments = "torture" + kSmall + " -w " + workload;
    EXPECT_EQ(draw(arguments), draw(arguments + " --lumibench-shadow")) << workload;
  }
}

TEST_F(Picture, ALeftOutEffectIsNamed) {
  const Outcome run =
      run_program("cornell --size 8x8 --spp 1 --effects diffuse,soft-shadow,emission");
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.output.find("lacks refraction"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace a2rt::test
