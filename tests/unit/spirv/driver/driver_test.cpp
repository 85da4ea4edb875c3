// Instrumented shaders on the real driver write exactly the records their program calls for.
#include "driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../test_modules.h"
#include "spirv/instrument.h"

namespace a2rt::spirv::testing {
namespace {

using capture::AnyHitVerdict;
using capture::Counter;
using capture::RecordKind;
using capture::Stage;
using capture::VerdictAction;
using ::testing::ElementsAre;

constexpr std::uint32_t kWidth = 4, kHeight = 3;                             // launches
constexpr std::uint32_t kTriangle = 0, kMasked = 1, kBox = 2, kNothing = 3;  // launch x
constexpr std::uint32_t kAcceptRow = 0, kIgnoreRow = 1, kTerminateRow = 2;   // launch y
constexpr std::uint32_t kEnough = 4096;

// "ray0" = kRay of a ray-generation shader: kind, then the stage's number.
std::vector<std::string> story(const std::vector<Recording::Record>& records) {
  constexpr const char* kKinds[] = {"?",      "ray", "hit",     "miss", "anyhit",
                                    "report", "end", "segment", "step", "verdict"};
  std::vector<std::string> told;
  for (const auto& record : records) {
    told.push_back(kKinds[static_cast<std::size_t>(record.kind)] +
                   std::to_string(static_cast<unsigned>(record.stage)));
  }
  return told;
}

class DriverTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    driver_ = Driver::open();
    if (driver_ != nullptr) {
      recording_ = std::make_unique<Recording>(*driver_, kEnough, kWidth * kHeight);
    }
  }
  static void TearDownTestSuite() {
    recording_.reset();
    driver_.reset();
  }
  void SetUp() override {
    if (driver_ == nullptr) {
      GTEST_SKIP() << "no lavapipe with ray tracing (Mesa 25.0 or later) on this machine";
    }
  }
  // The one recording, emptied: its address is part of the shaders, and compiling takes seconds.
  static Recording& fresh(std::uint32_t capacity = kEnough) {
    recording_->reset(capacity);
    return *recording_;
  }

  static Words rewritten(const std::string& shader, const Recording& recording,
                         std::uint32_t index) {
    InstrumentOptions options;
    options.header_address = recording.address();
    options.first_shader_index = index;
    return instrument(module_named(shader + ".v12"), options).words;
  }

  static void trace(const Recording& recording) {
    RayTracingShaders shaders;
    shaders.stages = {
        {VK_SHADER_STAGE_RAYGEN_BIT_KHR, rewritten("driver.rgen", recording, 0)},
        {VK_SHADER_STAGE_MISS_BIT_KHR, rewritten("driver.rmiss", recording, 1)},
        {VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, rewritten("driver.rchit", recording, 2)},
        {VK_SHADER_STAGE_ANY_HIT_BIT_KHR, rewritten("driver.rahit", recording, 3)},
        {VK_SHADER_STAGE_INTERSECTION_BIT_KHR, rewritten("driver.rint", recording, 4)}};
    shaders.hits = {
        {VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR, 2, 3, VK_SHADER_UNUSED_KHR},
        {VK_RAY_TRACING_SHADER_GROUP_TYPE_PROCEDURAL_HIT_GROUP_KHR, 2, 3, 4}};
    driver_->trace(shaders, kWidth, kHeight);
  }

  static std::vector<Recording::Record> launch(const Recording& recording, std::uint32_t x,
                                               std::uint32_t y) {
    return recording.of(x + kWidth * y);
  }

  static std::unique_ptr<Driver> driver_;
  static std::unique_ptr<Recording> recording_;
};
std::unique_ptr<Driver> DriverTest::driver_;
std::unique_ptr<Recording> DriverTest::recording_;

TEST_F(DriverTest, EachTargetTellsItsStory) {
  Recording& recording = fresh();
  trace(recording);
  // What a closest-hit shader does: hit, recursive ray, its miss, end.
  for (std::uint32_t row = 0; row < kHeight; ++row) {
    EXPECT_THAT(story(launch(recording, kTriangle, row)),
                ElementsAre("ray0", "hit3", "ray3", "miss4", "end4", "end3", "end0"));
    EXPECT_THAT(story(launch(recording, kNothing, row)),
                ElementsAre("ray0", "miss4", "end4", "end0"));
  }
  EXPECT_THAT(
      story(launch(recording, kMasked, kAcceptRow)),
      ElementsAre("ray0", "anyhit2", "end2", "hit3", "ray3", "miss4", "end4", "end3", "end0"));
  EXPECT_THAT(story(launch(recording, kMasked, kIgnoreRow)),
              ElementsAre("ray0", "anyhit2", "end2", "miss4", "end4", "end0"));
  EXPECT_THAT(
      story(launch(recording, kMasked, kTerminateRow)),
      ElementsAre("ray0", "anyhit2", "end2", "hit3", "ray3", "miss4", "end4", "end3", "end0"));
  EXPECT_THAT(story(launch(recording, kBox, kAcceptRow)),
              ElementsAre("ray0", "segment1", "report1", "anyhit2", "end2", "end1", "hit3", "ray3",
                          "miss4", "end4", "end3", "end0"));
  EXPECT_THAT(story(launch(recording, kBox, kIgnoreRow)),
              ElementsAre("ray0", "segment1", "report1", "anyhit2", "end2", "end1", "miss4", "end4",
                          "end0"));
  EXPECT_EQ(recording.header().lost, 0u);
  EXPECT_TRUE(recording.guard_intact());
}

TEST_F(DriverTest, ATerminatedRayKeepsTheRecordsOfItsIntersectionShader) {
  Recording& recording = fresh();
  trace(recording);
  const auto records = launch(recording, kBox, kTerminateRow);
  ASSERT_GE(records.size(), 4u);
  EXPECT_EQ(records[1].kind, RecordKind::kSegment);
  EXPECT_EQ(records[2].kind, RecordKind::kReport);
  EXPECT_EQ(records[2].words[10], 1u);  // accepted
  EXPECT_EQ(records[3].kind, RecordKind::kAnyHit);
  EXPECT_EQ(records[3].words[10], static_cast<std::uint32_t>(AnyHitVerdict::kTerminate));
}

TEST_F(DriverTest, RecordsHoldTheArgumentsAndTheHit) {
  Recording& recording = fresh();
  trace(recording);
  const auto records = launch(recording, kMasked, kAcceptRow);
  ASSERT_EQ(records.size(), 9u);
  const auto& ray = records[0];
  EXPECT_EQ(ray.dispatch, 77u);
  EXPECT_EQ(ray.ordinal, 0u);
  EXPECT_EQ(ray.shader, 0u);
  const float expected[] = {2.5f, -0.5f, 0.0f, 0.25f, 0.0f, 0.0f, 1.0f, 100.0f};
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(ray.real(4 + i), expected[i]) << i;
  }
  EXPECT_EQ(ray.words[12], 0u);            // flags
  EXPECT_EQ(ray.words[13], 0xffu);         // mask, no offset, stride or miss index
  EXPECT_EQ(ray.words[14], 0u);            // site
  EXPECT_EQ(ray.words[15], 0u);            // no verdict
  for (const std::size_t at : {1u, 3u}) {  // any-hit, then closest-hit
    EXPECT_EQ(records[at].ordinal, 1u);
    EXPECT_EQ(records[at].real(5), 5.0f);
    EXPECT_EQ(records[at].words[6], 0u);   // primitive
    EXPECT_EQ(records[at].words[7], 0u);   // instance
    EXPECT_EQ(records[at].words[8], 1u);   // geometry
    EXPECT_EQ(records[at].words[9], 10u);  // custom index
  }
  EXPECT_EQ(records[1].shader, 3u);
  EXPECT_EQ(records[3].shader, 2u);
  EXPECT_EQ(records[4].ordinal, 1u);  // the recursive ray is the second
  EXPECT_EQ(records[5].ordinal, 2u);

  const auto box = launch(recording, kBox, kIgnoreRow);
  EXPECT_EQ(box[2].words[4], 9u);  // hit kind
  EXPECT_EQ(box[2].real(5), 5.25f);
  EXPECT_EQ(box[2].words[7], 1u);   // instance
  EXPECT_EQ(box[2].words[9], 20u);  // custom index
  EXPECT_EQ(box[2].words[10], 0u);  // not accepted
  EXPECT_EQ(box[3].words[10], static_cast<std::uint32_t>(AnyHitVerdict::kIgnore));
}

TEST_F(DriverTest, CountersAreExactAcrossLoopsAndRecursion) {
  Recording& recording = fresh();
  trace(recording);
  const auto records = launch(recording, kTriangle, 0);
  ASSERT_EQ(records.size(), 7u);
  const auto& ray = records[2];  // ends the first segment of the closest-hit shader
  EXPECT_EQ(ray.counter(Counter::kSfu), 7u);
  // Eight comparisons and seven increments of the loop, one addition.
  EXPECT_EQ(ray.counter(Counter::kAlu), 8u + 7u + 1u);
  // Into the loop, then header and condition eight times, body and continue seven times.
  EXPECT_EQ(ray.counter(Counter::kControl), 1u + 8u + 8u + 7u + 7u);
  EXPECT_EQ(ray.counter(Counter::kPayload), 2u);
  const auto& end = records[5];
  EXPECT_EQ(end.counter(Counter::kSfu), 1u);
  EXPECT_EQ(end.counter(Counter::kAlu), 0u);
  EXPECT_EQ(end.counter(Counter::kPayload), 2u);
  EXPECT_EQ(records[4].counter(Counter::kPayload), 1u);  // the miss shader's

  const auto box = launch(recording, kBox, kAcceptRow);
  EXPECT_EQ(box[1].counter(Counter::kSfu), 1u);
  EXPECT_EQ(box[1].counter(Counter::kPayload), 2u);  // hit attributes
  EXPECT_EQ(box[5].counter(Counter::kSfu), 0u);
}

TEST_F(DriverTest, VerdictsBendTheRayButNotItsRecord) {
  Recording& recording = fresh();
  const auto action = [](VerdictAction a) { return static_cast<std::uint32_t>(a); };
  recording.set_verdict(kTriangle, {action(VerdictAction::kForceMiss), 0, 0, 0});
  recording.set_verdict(kMasked, {action(VerdictAction::kInterval), 6, 7, 0});
  recording.set_verdict(kBox, {action(VerdictAction::kKeep), 0, 0, 0});
  trace(recording);
  for (const std::uint32_t x : {kTriangle, kMasked}) {
    const auto records = launch(recording, x, 0);
    EXPECT_THAT(story(records), ElementsAre("ray0", "miss4", "end4", "end0"));
    EXPECT_EQ(records[0].words[15], 1u);
    EXPECT_EQ(records[0].words[13], 0xffu);
    EXPECT_EQ(records[0].real(7), 0.25f);
    EXPECT_EQ(records[0].real(11), 100.0f);
  }
  EXPECT_EQ(launch(recording, kBox, 0).size(), 12u);
  EXPECT_EQ(launch(recording, kBox, 0)[0].words[15], 0u);
  // Other launch ids and the second ray of a launch are not touched.
  EXPECT_EQ(launch(recording, kTriangle, 1).size(), 7u);
}

TEST_F(DriverTest, WhatDoesNotFitIsCountedAndHarmsNothing) {
  trace(fresh());
  const std::size_t all = recording_->count();
  for (const std::uint32_t capacity : {0u, 1u, 20u, 100u}) {
    Recording& recording = fresh(capacity);
    trace(recording);
    EXPECT_EQ(recording.count() + recording.header().lost, all) << capacity;
    EXPECT_TRUE(recording.guard_intact());
  }
}

TEST_F(DriverTest, LaunchIdsBeyondTheOrdinalsStayInBounds) {
  Recording& recording = fresh();
  recording.header().ordinal_launches = 2;
  trace(recording);
  EXPECT_EQ(launch(recording, kTriangle, 0).size(), 7u);
  EXPECT_EQ(launch(recording, kNothing, 2).size(), 4u);
}

TEST_F(DriverTest, RayQueriesTellEveryStepAndDecision) {
  Recording& recording = fresh();
  driver_->dispatch(rewritten("driver.comp", recording, 9), 2, 1);
  EXPECT_THAT(story(launch(recording, kNothing, 0)), ElementsAre("ray6", "step6", "end6"));
  EXPECT_THAT(story(launch(recording, kTriangle, 1)), ElementsAre("ray6", "step6", "end6"));
  const auto opaque = launch(recording, kTriangle, 0);
  EXPECT_EQ(opaque[1].words[4], 1u);  // committed triangle
  EXPECT_EQ(opaque[1].real(5), 5.0f);
  EXPECT_EQ(opaque[1].words[9], 10u);
  EXPECT_EQ(opaque[1].words[10], 0u);  // Proceed is through

  const auto masked = launch(recording, kMasked, kAcceptRow);
  EXPECT_THAT(story(masked), ElementsAre("ray6", "step6", "verdict6", "step6", "end6"));
  EXPECT_EQ(masked[1].words[4], 0u);   // nothing committed yet
  EXPECT_EQ(masked[1].words[10], 1u);  // there is a candidate
  EXPECT_EQ(masked[2].words[4], 0u);   // a triangle
  EXPECT_EQ(masked[2].real(5), 5.0f);
  EXPECT_EQ(masked[2].words[8], 1u);  // geometry
  EXPECT_EQ(masked[3].words[4], 1u);
  EXPECT_EQ(masked[0].shader, 9u);

  const auto box = launch(recording, kBox, kAcceptRow);
  EXPECT_THAT(story(box), ElementsAre("ray6", "step6", "verdict6", "step6", "end6"));
  EXPECT_EQ(box[2].words[4], 1u);  // an AABB
  EXPECT_EQ(box[2].real(5), 5.25f);
  EXPECT_EQ(box[3].words[4], 2u);  // generated
  EXPECT_EQ(box[3].real(5), 5.25f);
  EXPECT_EQ(box[3].words[9], 20u);

  const auto ended = launch(recording, kMasked, kTerminateRow);
  EXPECT_EQ(ended[2].words[10], static_cast<std::uint32_t>(AnyHitVerdict::kTerminate));
}

TEST_F(DriverTest, VerdictsBendRayQueriesToo) {
  Recording& recording = fresh();
  recording.set_verdict(kTriangle,
                        {static_cast<std::uint32_t>(VerdictAction::kForceMiss), 0, 0, 0});
  driver_->dispatch(rewritten("driver.comp", recording, 9), 2, 1);
  const auto bent = launch(recording, kTriangle, 0);
  EXPECT_EQ(bent[0].words[15], 1u);
  EXPECT_EQ(bent[1].words[4], 0u);
  EXPECT_EQ(launch(recording, kTriangle, 1)[1].words[4], 1u);
}

}  // namespace
}  // namespace a2rt::spirv::testing
