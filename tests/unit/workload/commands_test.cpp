// The commands import, check and inspect, as a user runs them: output, exit status, files left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "a2rt/workload/exact_walk.h"
#include "a2rt/workload/file.h"
#include "a2rt/workload/synthetic.h"
#include "core_run.h"
#include "raw_capture.h"
#include "scratch_folder.h"

namespace a2rt {
namespace {

using ::testing::HasSubstr;

using testing::CoreRun;
using testing::run_core;

class Commands : public ::testing::Test {
 protected:
  // A capture of one launch whose driver is the exact walk; `shift` falsifies the recorded hits.
  void capture(float shift = 0) {
    synthetic::Config config;
    config.shape = synthetic::Shape::kSphere;
    config.driver_nodes = true;
    config.reference = false;
    config.width = config.height = 8;
    const Workload scene = synthetic::make(config);
    const ExactWalk walk(scene);
    testing::RawRecords records;
    records.by(capture::Stage::kRayGeneration, 0);
    for (Ray ray : scene.rays) {
      ray.flags = 0;
      Hit hit = walk.walk(ray, {}).hit;
      records.by(capture::Stage::kRayGeneration, 0).ray(ray);
      if (hit.state == HitState::kHit) {
        hit.t += shift;
        records.by(capture::Stage::kClosestHit, 1).hit(hit).end(3);
      } else {
        records.by(capture::Stage::kMiss, 2).miss().end(1);
      }
    }
    records.by(capture::Stage::kRayGeneration, 0).end(5);
    testing::RawManifest manifest;
    manifest.driver("/bin/program");
    manifest.shader(0, capture::Stage::kRayGeneration);
    manifest.shader(1, capture::Stage::kClosestHit);
    manifest.shader(2, capture::Stage::kMiss);
    manifest.blas(1, 0x1000, scene.blas[0]);
    manifest.tlas(2, 0x2000, scene.tlas[0], {0x1000});
    manifest.dispatch(1, 1, 0);
    manifest.end(records.units());
    put("manifest.bin", manifest.bytes());
    put("records.bin", records.bytes());
  }
  void put(const std::string& name, const testing::Bytes& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  CoreRun import() const { return run_core("import " + folder_.path().string() + " -o " + file_); }

  testing::ScratchFolder folder_;
  std::string file_ = (folder_.path() / "w.h5").string();
};

TEST_F(Commands, ImportThenCheckFindsEveryRayEqual) {
  capture();
  const CoreRun imported = import();
  EXPECT_EQ(imported.status, 0) << imported.output;
  EXPECT_THAT(imported.output, HasSubstr("192 rays"));
  const CoreRun checked = run_core("check " + file_);
  EXPECT_EQ(checked.status, 0) << checked.output;
  EXPECT_THAT(checked.output, HasSubstr("192 bit-equal, 0 different (100.00000 % equal)"));
}

TEST_F(Commands, CheckOfAFalseCaptureExitsWithOne) {
  capture(1e-3f);
  ASSERT_EQ(import().status, 0);
  const CoreRun checked = run_core("check " + file_);
  EXPECT_EQ(checked.status, 1);
  EXPECT_THAT(checked.output, HasSubstr("another distance"));
}

TEST_F(Commands, InspectTellsCountsAndEffects) {
  capture();
  ASSERT_EQ(import().status, 0);
  const CoreRun table = run_core("inspect " + file_);
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.output, HasSubstr("closest_hit"));
  const CoreRun json = run_core("inspect --json " + file_);
  EXPECT_EQ(json.status, 0);
  EXPECT_THAT(json.output, HasSubstr("\"count\": 192"));
  EXPECT_THAT(json.output, HasSubstr("\"reason\": \"no candidate that a shader judged\""));
}

TEST_F(Commands, BadInputExitsWithTwoAndLeavesNoFile) {
  const CoreRun missing = import();
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.output, HasSubstr("no capture: manifest.bin is missing"));
  capture();
  std::filesystem::resize_file(folder_.path() / "records.bin", 160);
  const CoreRun cut = import();
  EXPECT_EQ(cut.status, 2);
  EXPECT_THAT(cut.output, HasSubstr("records.bin: cut off"));
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_EQ(run_core("check " + file_).status, 2);
  std::ofstream(folder_.path() / "manifest.bin.part") << "A2RM";
  EXPECT_THAT(import().output, HasSubstr("the capture is not complete"));
}

}  // namespace
}  // namespace a2rt
