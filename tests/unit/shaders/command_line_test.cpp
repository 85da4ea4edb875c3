// Exit status, messages, and nothing half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.h"

namespace a2rt::test {
namespace {

using ::testing::HasSubstr;

struct Refusal {
  std::string name, arguments, message;
};
class Refused : public ::testing::TestWithParam<Refusal> {};

TEST_P(Refused, EndsWithStatusTwoAndNoOutput) {
  const TemporaryFolder folder;
  const auto picture = folder.path() / "x.png";
  const Outcome run = run_program(GetParam().arguments + " -o " + picture.string());
  EXPECT_EQ(run.status, 2) << run.output;
  EXPECT_THAT(run.output, HasSubstr(GetParam().message));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, Refused,
    ::testing::Values(
        Refusal{"no_scene", "", "name a scene"},
        Refusal{"absent_file", "nowhere.glb", "no such file"},
        Refusal{"absent_scene", "nowhere", "no embedded scene 'nowhere'; known: cornell"},
        Refusal{"bad_size", "cornell --size 0x5", "WIDTHxHEIGHT"},
        Refusal{"bad_workload", "cornell -w dance", "known: auto"},
        Refusal{"bad_effect", "cornell --effects sparkle", "no effect 'sparkle'"},
        Refusal{"bad_camera", "cornell --camera 1,1,1/1,1,1/40", "sees no area"},
        Refusal{"bad_angle", "cornell --camera 0,0,9/1,1,1/180", "sees no area"},
        Refusal{"unknown_camera", "cornell --camera side", "no camera 'side'"},
        Refusal{"bad_length", "cornell -w ao --ao-distance near", "length above 0"},
        Refusal{"too_deep", "cornell -w whitted --max-bounces 20", "at most 7 bounces"}),
    [](const auto& test) { return test.param.name; });

TEST(CommandLine, NeedsLavapipeAndSaysHowToGetIt) {
  const Outcome run = run_program("cornell --size 8x8", "VK_ICD_FILENAMES=/nonexistent.json");
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.output, HasSubstr("mesa-vulkan-drivers"));
}

TEST(CommandLine, ListsEffectsAsJsonWithoutADevice) {
  const Outcome run = run_program("cornell --list-effects", "VK_ICD_FILENAMES=/nonexistent.json");
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("\"refraction\""));
  EXPECT_THAT(run.output, HasSubstr("material glass"));
}

TEST(CommandLine, AnUnwritableOutputIsAnError) {
  if (const std::string reason = why_no_device(); !reason.empty()) {
    GTEST_SKIP() << reason;
  }
  const Outcome run = run_program("cornell --size 4x4 --spp 1 -o /nonexistent/x.png");
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.output, HasSubstr("cannot write /nonexistent/x.png"));
}

}  // namespace
}  // namespace a2rt::test
