// Memory of the layer in long captures, measured on whole processes.
#include <gtest/gtest.h>

#include "capture_files.h"
#include "layer_run.h"

namespace a2rt::test {
namespace {

constexpr std::uint64_t kRays = std::uint64_t{22 * 96} * (31 * 64);
constexpr std::int64_t kMiB = 1 << 20;

TEST(Memory, a_frame_of_four_million_rays_needs_less_than_512_MiB_in_the_layer) {
  const Folder folder;
  const RunResult plain = run_program("many_rays", folder, false);
  if (plain.status != 0) {
    GTEST_SKIP() << "needs lavapipe with ray-tracing pipelines: " << plain.output;
  }
  const RunResult under =
      run_program("many_rays", folder, true, {{"A2RT_CAPTURE", folder.path("capture")}});
  ASSERT_EQ(under.status, 0) << under.output;
  EXPECT_TRUE(under.picture == plain.picture);
  const std::int64_t layer = under.peak_bytes - plain.peak_bytes;
  RecordProperty("layer_MiB", std::to_string(layer / kMiB));
  EXPECT_LT(layer, 512 * kMiB);

  const CaptureFiles files = read_capture(folder.path("capture"));
  EXPECT_EQ(files.end.lost_records, 0u);
  EXPECT_EQ(count_records(files).kinds.at(capture::RecordKind::kRay), kRays);
  const auto written = static_cast<std::int64_t>(files.records.size() * sizeof(std::uint32_t));
  RecordProperty("records_MiB", std::to_string(written / kMiB));
  // Otherwise all records could have stayed in memory and the limit would show nothing.
  EXPECT_GT(written, 512 * kMiB);
}

}  // namespace
}  // namespace a2rt::test
