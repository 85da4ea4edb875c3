#include "a2rt/workload/import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "a2rt/workload/check.h"
#include "a2rt/workload/exact_walk.h"
#include "a2rt/workload/reference.h"
#include "a2rt/workload/synthetic.h"
#include "raw_capture.h"

namespace a2rt {
namespace {

using capture::AnyHitVerdict;
using capture::Stage;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::import_error;
using testing::import_raw;
using testing::RawManifest;
using testing::RawRecords;

// Shader indices of the hand-made programs.
enum : std::uint32_t { kRaygen, kChit, kMissShader, kAhit, kIsec, kCallable, kCompute };
constexpr Stage kStages[] = {Stage::kRayGeneration, Stage::kClosestHit,   Stage::kMiss,
                             Stage::kAnyHit,        Stage::kIntersection, Stage::kCallable,
                             Stage::kCompute};
constexpr std::uint64_t kBlasAddress = 0x1000, kTlasAddress = 0x9000;

ImportOptions tolerant() {
  ImportOptions options;
  options.tolerate_lost = true;
  return options;
}

// A program over a synthetic scene whose driver is the exact walk.
class Capture : public ::testing::Test {
 protected:
  void SetUp() override { use(synthetic::Shape::kSphere, 0); }

  void use(synthetic::Shape shape, double masked) {
    synthetic::Config config;
    config.shape = shape;
    config.primitives = 200;
    config.masked_share = masked;
    config.driver_nodes = true;
    config.reference = false;
    config.width = config.height = 4;
    scene_ = synthetic::make(config);
    for (Ray& ray : scene_.rays) {
      ray.tlas = 0;
    }
    walk_ = std::make_unique<ExactWalk>(scene_);
  }
  void begin_manifest() {
    manifest_.driver("/usr/bin/program --fast");
    for (std::uint32_t i = 0; i < std::size(kStages); ++i) {
      manifest_.shader(i, kStages[i]);
    }
    manifest_.query_site(kCompute, 0);
    manifest_.blas(1, kBlasAddress, scene_.blas[0]);
    manifest_.tlas(2, kTlasAddress, scene_.tlas[0], {kBlasAddress});
  }
  void one_dispatch(std::uint32_t width = 4, std::uint32_t height = 4) {
    begin_manifest();
    manifest_.dispatch(width, height, 0);
    manifest_.end(records_.units());
  }
  // A ray whose outcome is as asked, and what the driver finds.
  std::pair<Ray, Hit> ray_with(HitState state, std::uint32_t flags = 0) {
    for (; next_ < scene_.rays.size(); ++next_) {
      Ray ray = scene_.rays[next_];
      ray.flags = flags;
      const Hit hit = walk_->walk(ray, {}).hit;
      if (hit.state == state) {
        ++next_;
        return {ray, hit};
      }
    }
    throw std::runtime_error("no such ray");
  }
  RawRecords& by(std::uint32_t shader, std::uint32_t launch = 0) {
    return records_.by(kStages[shader], shader, launch);
  }

  Workload scene_;
  std::unique_ptr<ExactWalk> walk_;
  RawManifest manifest_;
  RawRecords records_;
  std::size_t next_ = 0;
};

TEST_F(Capture, NestedTracesGetTheirParents) {
  const auto [a, hit_a] = ray_with(HitState::kHit);
  const auto [b, hit_b] = ray_with(HitState::kHit);
  const auto [c, miss_c] = ray_with(HitState::kMiss);
  const auto [d, miss_d] = ray_with(HitState::kMiss);
  by(kRaygen).ray(a);
  by(kChit).hit(hit_a).ray(b);
  by(kChit).hit(hit_b).ray(c);  // the same shader, one level deeper
  by(kMissShader).miss().end(1);
  by(kChit).end(2).end(3);
  by(kRaygen).ray(d);
  by(kMissShader).miss().end(4);
  by(kRaygen).end(5);
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  ASSERT_EQ(w.rays.size(), 4u);
  std::vector<std::uint32_t> parents, ends;
  for (const Ray& ray : w.rays) {
    parents.push_back(ray.parent);
  }
  EXPECT_THAT(parents, ElementsAre(kNone, 0, 1, kNone));
  EXPECT_EQ(w.driver_hits[0], hit_a);
  EXPECT_EQ(w.driver_hits[1], hit_b);
  EXPECT_EQ(w.driver_hits[2].state, HitState::kMiss);
  EXPECT_EQ(w.driver_hits[3].state, HitState::kMiss);
  for (const Segment& s : w.segments) {
    if (s.ray == kNone) {
      ends.push_back(s.counts[0]);
    }
  }
  EXPECT_THAT(ends, ElementsAre(1, 2, 3, 4, 5));
  EXPECT_TRUE(check_workload(w).passed());
  EXPECT_EQ(check_workload(w).equal, 4u);
  EXPECT_EQ(w.provenance.program, "program");
}

TEST_F(Capture, LaunchesThatRanTogetherAreTakenApart) {
  const auto [a, hit_a] = ray_with(HitState::kHit);
  const auto [b, miss_b] = ray_with(HitState::kMiss);
  by(kRaygen, 3).ray(a);
  by(kRaygen, 1).ray(b);
  by(kChit, 3).hit(hit_a);
  by(kMissShader, 1).miss().end();
  by(kRaygen, 1).end();
  by(kChit, 3).end();
  by(kRaygen, 3).end();
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  ASSERT_EQ(w.rays.size(), 2u);
  EXPECT_EQ(w.rays[0].launch, 1u);
  EXPECT_EQ(w.driver_hits[0].state, HitState::kMiss);
  EXPECT_EQ(w.driver_hits[1], hit_a);
}

TEST_F(Capture, RaysWithoutShaderAreInferredByTheWalk) {
  const std::uint32_t shadow = kRayTerminateOnFirstHit | kRaySkipClosestHit;
  const auto [a, hit_a] = ray_with(HitState::kHit, shadow);
  const auto [b, hit_b] = ray_with(HitState::kHit);
  const auto [c, miss_c] = ray_with(HitState::kMiss);
  by(kRaygen).ray(a).ray(b);
  by(kChit).hit(hit_b).end();
  by(kRaygen).ray(c).end();
  one_dispatch();
  ImportReport report;
  const Workload w = import_raw(manifest_, records_, {}, &report);
  EXPECT_EQ(report.inferred_hits, 1u);
  EXPECT_EQ(report.inferred_misses, 1u);
  EXPECT_EQ(w.driver_hits[0].state, HitState::kHitInferred);
  EXPECT_EQ(w.driver_hits[0].primitive, hit_a.primitive);
  EXPECT_EQ(w.driver_hits[2].state, HitState::kMiss);
  EXPECT_EQ(w.rays[0].flags, shadow);
}

TEST_F(Capture, WithoutDriverNodesRaysWithoutShaderStayUnknown) {
  scene_.blas[0].driver_nodes.clear();
  const auto ray = scene_.rays[0];
  by(kRaygen).ray(ray).end();
  one_dispatch();
  ImportReport report;
  const Workload w = import_raw(manifest_, records_, {}, &report);
  EXPECT_EQ(w.driver_hits[0].state, HitState::kUnknown);
  EXPECT_EQ(report.unknown, 1u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_THAT(report.warnings[0], HasSubstr("blas 0: the driver's nodes were not captured"));
}

TEST_F(Capture, OverriddenRaysAreMarkedAndNotInferred) {
  const auto [a, hit_a] = ray_with(HitState::kHit);
  by(kRaygen).ray(a, 0, true).ray(a, 0, true);
  by(kMissShader).miss().end();
  by(kRaygen).end();
  one_dispatch();
  ImportReport report;
  const Workload w = import_raw(manifest_, records_, {}, &report);
  EXPECT_EQ(report.overridden, 2u);
  EXPECT_EQ(w.driver_hits[0].state, HitState::kUnknown);
  EXPECT_EQ(w.driver_hits[1].state, HitState::kMiss);
  EXPECT_NE(w.rays[0].flags & kRayOverridden, 0u);
  EXPECT_EQ(check_workload(w).overridden, 2u);
}

TEST_F(Capture, AnyHitVerdictsBelongToTheRayBeingTraced) {
  use(synthetic::Shape::kSoup, 1.0);
  // What the driver would ask of an any-hit shader that ignores odd primitives.
  std::uint64_t judged = 0;
  for (std::size_t i = 0; i < scene_.rays.size(); ++i) {
    Ray ray = scene_.rays[i];
    ray.flags = 0;
    std::vector<Candidate> verdicts;
    WalkResult walk = walk_->walk(ray, verdicts, true);
    while (verdicts.size() < walk.met.size()) {  // each verdict can lead to further candidates
      verdicts.push_back(walk.met[verdicts.size()]);
      verdicts.back().verdict = verdicts.back().primitive % 2;
      walk = walk_->walk(ray, verdicts, true);
    }
    const auto launch = static_cast<std::uint32_t>(i % 16);
    by(kRaygen, launch).ray(ray);
    for (const Candidate& c : verdicts) {
      const Hit at{HitState::kHit, c.t, c.instance, c.geometry, c.primitive, c.kind};
      by(kAhit, launch).any_hit(at, static_cast<AnyHitVerdict>(c.verdict)).end(7);
      ++judged;
    }
    if (walk.hit.state == HitState::kHit) {
      by(kChit, launch).hit(walk.hit).end();
    } else {
      by(kMissShader, launch).miss().end();
    }
  }
  for (std::uint32_t launch = 0; launch < 16; ++launch) {
    by(kRaygen, launch).end();
  }
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  EXPECT_GT(judged, 5u);
  EXPECT_EQ(w.candidates.size(), judged);
  const CheckReport report = check_workload(w);
  EXPECT_EQ(report.equal, scene_.rays.size());
  EXPECT_EQ(report.different, 0u);
}

TEST_F(Capture, ReportsOfIntersectionShadersAreReplayed) {
  use(synthetic::Shape::kSpheres, 0);
  // Find a ray that a reported sphere stops, reporting only its nearest candidate.
  const auto reports = [&](std::size_t i) { return candidates_of(scene_, i); };
  std::size_t index = 0;
  Candidate nearest;
  for (; index < scene_.rays.size(); ++index) {
    const auto all = reports(index);
    const auto best = std::min_element(all.begin(), all.end(), [](const auto& x, const auto& y) {
      return (x.verdict != 0 ? x.t : 1e30f) < (y.verdict != 0 ? y.t : 1e30f);
    });
    if (best != all.end() && best->verdict != 0) {
      nearest = *best;
      break;
    }
  }
  ASSERT_LT(index, scene_.rays.size());
  Ray ray = scene_.rays[index];
  ray.flags = 0;
  const Hit hit{HitState::kHit,   nearest.t,         nearest.instance,
                nearest.geometry, nearest.primitive, nearest.kind};
  Hit beyond = hit;
  beyond.t = nearest.t * 2;
  by(kRaygen).ray(ray);
  by(kIsec).segment(9).report(hit, true).segment(4).report(beyond, false).end(3);
  by(kChit).hit(hit).end();
  by(kRaygen).end();
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  ASSERT_EQ(w.candidates.size(), 2u);
  EXPECT_EQ(w.candidates[0].is_report, 1u);
  EXPECT_EQ(w.candidates[1].verdict, 0u);
  EXPECT_EQ(check_workload(w).equal, 1u);
}

TEST_F(Capture, AnIntersectionShaderCutShortByATerminatingAnyHitEndsToo) {
  use(synthetic::Shape::kSpheres, 0);
  const Hit hit{HitState::kHit, 0.5f, 0, 0, 3, 0};
  const auto [b, miss_b] = ray_with(HitState::kMiss);
  by(kRaygen).ray(scene_.rays[0]);
  by(kIsec).segment(1).report(hit, true);
  by(kAhit).any_hit(hit, AnyHitVerdict::kTerminate).end(2);
  by(kChit).hit(hit).ray(b);  // no kEnd of the intersection shader
  by(kMissShader).miss().end(3);
  by(kChit).end(4);
  by(kRaygen).end(5);
  one_dispatch();
  ImportReport report;
  const Workload w = import_raw(manifest_, records_, {}, &report);
  EXPECT_EQ(report.orphans, 0u);
  ASSERT_EQ(w.rays.size(), 2u);
  EXPECT_EQ(w.rays[1].parent, 0u);
  ASSERT_EQ(w.candidates.size(), 2u);
  EXPECT_EQ(w.candidates[1].verdict, static_cast<std::uint32_t>(AnyHitVerdict::kTerminate));
}

TEST_F(Capture, CallablesLeaveSegmentsOnly) {
  const auto [a, miss_a] = ray_with(HitState::kMiss);
  by(kRaygen).segment(1);
  by(kCallable).segment(2).end(3).end(4);  // a callable that calls itself
  by(kRaygen).ray(a);
  by(kMissShader).miss().end(5);
  by(kRaygen).end(6);
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  EXPECT_EQ(w.segments.size(), 7u);
  EXPECT_EQ(w.rays.size(), 1u);
}

TEST_F(Capture, QueriesGetTheCandidatesTheyPassedOver) {
  use(synthetic::Shape::kSoup, 1.0);
  // A query that confirms even primitives only; passing over leaves no record.
  std::uint64_t passed_over = 0;
  for (std::uint32_t i = 0; i < scene_.rays.size(); ++i) {
    Ray ray = scene_.rays[i];
    ray.flags = kRayQuery;
    by(kCompute, i % 16).ray(ray);
    std::vector<Candidate> verdicts;
    WalkResult walk = walk_->walk(ray, verdicts, true);
    Hit committed;
    while (verdicts.size() < walk.met.size()) {
      const Candidate& c = walk.met[verdicts.size()];
      const Hit at{HitState::kHit, c.t, c.instance, c.geometry, c.primitive, c.kind};
      records_.step(committed, true);
      verdicts.push_back(c);
      verdicts.back().verdict = c.primitive % 2;
      if (c.primitive % 2 == 0) {
        records_.query_verdict(at, false, AnyHitVerdict::kAccept);
        committed = at;
      } else {
        ++passed_over;
      }
      walk = walk_->walk(ray, verdicts, true);
    }
    records_.step(committed, false).end();
  }
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  EXPECT_EQ(w.rays.size(), scene_.rays.size());
  EXPECT_NE(w.rays[0].flags & kRayQuery, 0u);
  const auto ignored = std::count_if(w.candidates.begin(), w.candidates.end(),
                                     [](const Candidate& c) { return c.verdict == 1; });
  EXPECT_GT(passed_over, 0u);
  EXPECT_EQ(static_cast<std::uint64_t>(ignored), passed_over);
  EXPECT_EQ(check_workload(w).equal, scene_.rays.size());
}

TEST_F(Capture, QueriesAliveAtOnceKeepTheirOwnRecords) {
  const auto [a, hit_a] = ray_with(HitState::kHit);
  const auto [b, miss_b] = ray_with(HitState::kMiss);
  by(kCompute).ray(a).ray(b).of_query(0).step({}, true).of_query(1).step({}, false);
  records_.of_query(0).query_verdict(hit_a, false, AnyHitVerdict::kAccept).step(hit_a, false).end();
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  EXPECT_EQ(w.driver_hits[0].state, HitState::kHit);
  EXPECT_EQ(w.driver_hits[0].t, hit_a.t);
  EXPECT_EQ(w.driver_hits[1].state, HitState::kMiss);
  EXPECT_EQ(candidates_of(w, 1).size(), 0u);
}

TEST_F(Capture, UnfinishedQueriesAreUnknown) {
  by(kCompute).ray(scene_.rays[0]).ray(scene_.rays[1]).step({}, true).end();
  one_dispatch();
  const Workload w = import_raw(manifest_, records_);
  EXPECT_EQ(w.driver_hits[0].state, HitState::kUnknown);
  EXPECT_EQ(w.driver_hits[1].state, HitState::kUnknown);
}

TEST_F(Capture, EveryDispatchSeesItsVersionOfTheScene) {
  const auto [a, hit_a] = ray_with(HitState::kHit);
  Blas away = scene_.blas[0];
  for (Triangle& t : away.triangles) {
    for (Vec3& v : t.v) {
      v.x += 100;
    }
  }
  Workload moved = scene_;
  moved.blas[0] = away;
  for (std::uint32_t d = 0; d < 3; ++d) {
    records_.begin_dispatch(d);
    records_.by(Stage::kRayGeneration, kRaygen).ray(a);
    if (d == 1) {
      by(kMissShader).miss().end();
    } else {
      by(kChit).hit(hit_a).end();
    }
    by(kRaygen).end();
  }
  const std::uint64_t units = records_.units();
  begin_manifest();
  manifest_.blas(3, 0x5000, scene_.blas[0]);  // used by no dispatch
  manifest_.dispatch(1, 1, 0, {{kRaygen, 0, 2}});
  manifest_.blas(4, kBlasAddress, away);  // rebuilt in place, the TLAS as it was
  manifest_.dispatch(1, 1, 6 + 3 + 3 + 3, {{kRaygen, 0, 2}});
  manifest_.copy(0x5000, kBlasAddress, 5);
  manifest_.copy(kTlasAddress, 0xa000, 6);
  manifest_.dispatch(1, 1, (6 + 3 + 3 + 3) + (6 + 1 + 3 + 3), {{kRaygen, 0, 6}});
  manifest_.end(units);
  // The moved BLAS keeps its old tree, which is not the driver's; only the hits count here.
  const Workload w = import_raw(manifest_, records_);
  EXPECT_EQ(w.blas.size(), 3u);
  EXPECT_EQ(w.tlas.size(), 3u);
  EXPECT_EQ(w.rays[1].tlas, 1u);
  EXPECT_EQ(w.blas[w.tlas[1].instances[0].blas].triangles[0].v[0].x,
            scene_.blas[0].triangles[0].v[0].x + 100);
  EXPECT_EQ(w.dispatches[2].frame, 2u);
  EXPECT_EQ(reference_hit(w, w.rays[2], {}).primitive, hit_a.primitive);
}

TEST_F(Capture, AnUnknownStructureAmongSeveralIsRefused) {
  by(kRaygen).ray(scene_.rays[0]).end();
  begin_manifest();
  manifest_.tlas(9, 0xb000, scene_.tlas[0], {kBlasAddress});
  manifest_.dispatch(1, 1, 0, {{kRaygen, 0, 0}});
  manifest_.end(records_.units());
  EXPECT_EQ(import_error(manifest_.bytes(), records_.bytes()),
            "dispatch 0: trace site 0 of shader 0 uses an acceleration structure that the layer "
            "could not tell among several");
}

TEST_F(Capture, AnUnknownStructureIsTheOnlyOneThatStillExists) {
  by(kRaygen).ray(scene_.rays[0]).end();
  begin_manifest();
  manifest_.tlas(9, 0xb000, scene_.tlas[0], {kBlasAddress});
  manifest_.destroy(kTlasAddress);
  manifest_.dispatch(1, 1, 0, {{kRaygen, 0, 0}});
  manifest_.end(records_.units());
  EXPECT_EQ(import_error(manifest_.bytes(), records_.bytes()), "no error");
}

TEST_F(Capture, LostRecordsAreAnErrorUnlessTolerated) {
  by(kRaygen).ray(scene_.rays[0]).end();
  begin_manifest();
  manifest_.dispatch(1, 1, 0);
  manifest_.end(records_.units(), 5);
  EXPECT_EQ(import_error(manifest_.bytes(), records_.bytes()),
            "5 records did not fit the layer's buffer and are lost; capture again with a larger "
            "buffer or fewer pixels, or import with --tolerate-lost");
  ImportReport report;
  import_raw(manifest_, records_, tolerant(), &report);
  EXPECT_EQ(report.lost, 5u);
}

TEST_F(Capture, RecordsOutOfPlaceAreAnErrorUnlessTolerated) {
  by(kChit).hit({HitState::kHit, 1, 0, 0, 0, 0xFE}).end();
  by(kRaygen).ray(scene_.rays[0]);
  by(kMissShader).miss().miss().end();
  by(kRaygen).end();
  one_dispatch();
  EXPECT_THAT(import_error(manifest_.bytes(), records_.bytes()),
              HasSubstr("records fit no place in the nesting of shader calls"));
  ImportReport report;
  const Workload w = import_raw(manifest_, records_, tolerant(), &report);
  EXPECT_EQ(report.orphans, 3u);
  EXPECT_EQ(w.rays.size(), 1u);
}

TEST_F(Capture, RefusalsOfTheLayerAreHandedOn) {
  by(kRaygen).ray(scene_.rays[0]).end();
  begin_manifest();
  manifest_.refused("a motion-blur build");
  manifest_.dispatch(1, 1, 0);
  manifest_.end(records_.units());
  ImportReport report;
  EXPECT_EQ(import_raw(manifest_, records_, {}, &report).provenance.refused, "a motion-blur build");
  EXPECT_THAT(report.warnings, ElementsAre("the layer could not capture: a motion-blur build"));
}

TEST_F(Capture, DamagedRecordsAreNamedByTheirByte) {
  by(kRaygen).ray(scene_.rays[0]).end();
  one_dispatch();
  testing::Bytes bad = records_.bytes();
  bad[6 * 16] = std::byte{77};
  EXPECT_EQ(import_error(manifest_.bytes(), bad),
            "records.bin: byte 96: record of unknown kind 77; the capture is damaged, capture "
            "again");
  bad = records_.bytes();
  bad[8] = std::byte{3};
  EXPECT_THAT(import_error(manifest_.bytes(), bad),
              HasSubstr("byte 0: record of dispatch 3 among those of dispatch 0"));
  bad = records_.bytes();
  bad[4] = std::byte{16};
  EXPECT_THAT(import_error(manifest_.bytes(), bad), HasSubstr("byte 0: launch id 16 of only 16"));
  bad = records_.bytes();
  bad[2] = std::byte{60};
  EXPECT_THAT(import_error(manifest_.bytes(), bad),
              HasSubstr("a record of shader 60, but the manifest names only 7"));
  bad = records_.bytes();
  bad.resize(bad.size() - 16);
  EXPECT_THAT(import_error(manifest_.bytes(), bad), HasSubstr("cut off: 8 units of 9"));
}

TEST_F(Capture, AManifestCutOffAnywhereIsRefused) {
  by(kRaygen).ray(scene_.rays[0]).end();
  one_dispatch();
  const std::span<const std::byte> whole(manifest_.bytes());
  for (std::size_t length = 0; length < whole.size(); length += length < 600 ? 1 : 59) {
    EXPECT_THAT(import_error(whole.first(length), records_.bytes()), HasSubstr("manifest.bin"))
        << length;
  }
  EXPECT_EQ(import_error(whole, records_.bytes()), "no error");
}

TEST_F(Capture, FlippedBitsNeverCrashTheImporter) {
  const auto [a, hit_a] = ray_with(HitState::kHit);
  by(kRaygen).ray(a);
  by(kChit).hit(hit_a).end();
  by(kRaygen).ray(a).end();
  by(kCompute, 1).ray(a).step({}, true).query_verdict(hit_a, false, AnyHitVerdict::kAccept);
  records_.step(hit_a, false).end();
  one_dispatch();
  synthetic::Random random(3);
  std::size_t refused = 0;
  for (int i = 0; i < 3000; ++i) {
    testing::Bytes manifest = manifest_.bytes(), records = records_.bytes();
    testing::Bytes& target = i % 2 == 0 ? manifest : records;
    // Headers are where damage hurts; the bulk of the manifest is geometry.
    const std::size_t range =
        i % 4 == 0 ? std::min<std::size_t>(target.size(), 900) : target.size();
    target[random.bits() % range] ^= static_cast<std::byte>(1u << random.below(8));
    refused += import_error(manifest, records) != "no error" ? 1U : 0U;
  }
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace a2rt
