// The layer as its users see it: foreign programs run under it in their own processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>

#include "capture/capture_lock.h"
#include "capture_files.h"
#include "layer_run.h"

namespace a2rt::test {
namespace {

using capture::BlockType;
using capture::RecordKind;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::uint64_t kPixels = 96 * 64;

// Empty if a device with ray-tracing pipelines is installed; asked once.
const std::string& missing_driver() {
  static const std::string reason = [] {
    const Folder folder;
    const RunResult result = run_program("hit_groups", folder, false);
    return result.status == 0 ? std::string() : result.output;
  }();
  return reason;
}

#define NEEDS_LAVAPIPE()                                                               \
  if (!missing_driver().empty()) {                                                     \
    GTEST_SKIP() << "needs lavapipe with ray-tracing pipelines: " << missing_driver(); \
  }

// What a program's capture must hold.
struct Expectation {
  const char* program;
  std::size_t dispatches;
  std::uint64_t least_rays;
  RecordKind characteristic;  // a kind of record that it must have
  bool refuses = false;
};

void PrintTo(const Expectation& expectation, std::ostream* out) { *out << expectation.program; }

std::size_t distinct_pixels(const std::string& picture) {
  std::set<std::string> pixels;
  for (std::size_t i = picture.size() - kPixels * 3; i + 3 <= picture.size(); i += 3) {
    pixels.insert(picture.substr(i, 3));
  }
  return pixels.size();
}

class ForeignProgram : public testing::TestWithParam<Expectation> {};

TEST_P(ForeignProgram, draws_the_same_picture_and_leaves_a_whole_capture) {
  NEEDS_LAVAPIPE();
  const Expectation& expected = GetParam();
  const Folder folder;
  const RunResult plain = run_program(expected.program, folder, false);
  ASSERT_EQ(plain.status, 0) << plain.output;
  // A picture of few colors would be equal for many wrong reasons.
  ASSERT_TRUE(distinct_pixels(plain.picture) > 8);

  const std::string capture_folder = folder.path("capture");
  for (const char* rebuild : {"off", "sah"}) {
    const RunResult under =
        run_program(expected.program, folder, true,
                    {{"A2RT_CAPTURE", capture_folder}, {"A2RT_REBUILD", rebuild}});
    ASSERT_EQ(under.status, 0) << under.output;
    EXPECT_TRUE(under.picture == plain.picture) << "A2RT_REBUILD=" << rebuild;
    EXPECT_FALSE(file_exists(capture_folder + "/manifest.bin.part"));

    const CaptureFiles files = read_capture(capture_folder);
    const RecordCounts counts = count_records(files);
    EXPECT_EQ(counts.orphans, 0u);
    EXPECT_EQ(counts.strays, 0u);
    EXPECT_EQ(files.end.lost_records, 0u);
    EXPECT_EQ(files.dispatches.size(), expected.dispatches);
    EXPECT_GE(counts.kinds.at(RecordKind::kRay), expected.least_rays);
    EXPECT_GT(counts.kinds.count(expected.characteristic), 0u);
    EXPECT_EQ(files.refused.empty(), !expected.refuses);
    for (const CapturedDispatch& dispatch : files.dispatches) {
      EXPECT_EQ(dispatch.block.width, 96u);
      EXPECT_EQ(dispatch.block.height, 64u);
      for (const capture::SiteBinding& binding : dispatch.bindings) {
        EXPECT_NE(binding.tlas_id, 0u) << "site " << binding.site;
      }
    }
    for (const CapturedStructure& structure : files.structures) {
      EXPECT_GT(structure.block.node_bytes, 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Vulkan, ForeignProgram,
    testing::Values(Expectation{"any_hit", 1, kPixels, RecordKind::kAnyHit},
                    Expectation{"callable", 1, kPixels, RecordKind::kSegment},
                    Expectation{"compaction", 1, kPixels, RecordKind::kHit},
                    Expectation{"formats", 1, kPixels, RecordKind::kHit},
                    Expectation{"hit_groups", 1, kPixels, RecordKind::kHit},
                    Expectation{"inactive_boxes", 1, kPixels, RecordKind::kReport},
                    Expectation{"indirect", 2, 2 * kPixels, RecordKind::kMiss},
                    Expectation{"instances", 1, 2 * kPixels, RecordKind::kHit},
                    Expectation{"library", 1, kPixels, RecordKind::kHit},
                    Expectation{"procedural", 1, kPixels, RecordKind::kReport},
                    Expectation{"query_alive", 1, 3 * kPixels, RecordKind::kQueryVerdict},
                    Expectation{"query_compute", 1, kPixels, RecordKind::kQueryVerdict},
                    Expectation{"pushes", 3, 3 * kPixels, RecordKind::kHit},
                    Expectation{"query_coverage", 1, kPixels, RecordKind::kQueryStep, true},
                    Expectation{"query_depth", 1, kPixels, RecordKind::kQueryStep},
                    Expectation{"query_dispatch_base", 1, kPixels / 2, RecordKind::kQueryStep,
                                true},
                    Expectation{"query_fragment", 1, kPixels, RecordKind::kQueryStep},
                    Expectation{"query_draws", 5, 5 * kPixels, RecordKind::kQueryStep},
                    Expectation{"query_feedback", 2, 2 * kPixels, RecordKind::kQueryStep, true},
                    Expectation{"query_mesh", 3, 3 * kPixels, RecordKind::kQueryStep},
                    Expectation{"query_multi_draw", 2, 2 * kPixels, RecordKind::kQueryStep},
                    Expectation{"query_product_size", 1, kPixels, RecordKind::kQueryVerdict},
                    Expectation{"query_render_pass", 1, kPixels, RecordKind::kQueryStep},
                    Expectation{"query_secondary", 1, kPixels, RecordKind::kQueryStep},
                    Expectation{"recursion", 1, kPixels + 1000, RecordKind::kHit},
                    Expectation{"secondary", 2, 2 * kPixels, RecordKind::kHit},
                    Expectation{"shadow", 1, kPixels + 1000, RecordKind::kMiss},
                    Expectation{"submit2", 3, 3 * kPixels, RecordKind::kHit},
                    Expectation{"templates", 2, 2 * kPixels, RecordKind::kHit},
                    Expectation{"two_tlas", 2, 4 * kPixels, RecordKind::kHit},
                    Expectation{"vertex_formats", 1, kPixels, RecordKind::kHit},
                    Expectation{"update", 2, 2 * kPixels, RecordKind::kHit}),
    [](const auto& one) { return std::string(one.param.program); });

CaptureFiles capture_of(const std::string& program, const Folder& folder,
                        Environment environment = {}) {
  environment["A2RT_CAPTURE"] = folder.path("capture");
  const RunResult result = run_program(program, folder, true, environment);
  EXPECT_EQ(result.status, 0) << result.output;
  return read_capture(folder.path("capture"));
}

TEST(Capture, each_frame_has_its_own_structures_after_an_update) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles files = capture_of("update", folder);
  std::vector<std::uint64_t> tlas;
  for (const CapturedDispatch& dispatch : files.dispatches) {
    ASSERT_EQ(dispatch.bindings.size(), 1u);
    tlas.push_back(dispatch.bindings[0].tlas_id);
  }
  ASSERT_EQ(tlas.size(), 2u);
  EXPECT_NE(tlas[0], tlas[1]);
  EXPECT_EQ(files.dispatches[0].block.frame, 0u);
  EXPECT_EQ(files.dispatches[1].block.frame, 1u);
  // Built once, then updated by each of the two executions of one command buffer.
  std::vector<const CapturedStructure*> bottom;
  for (const CapturedStructure& structure : files.structures) {
    if (!structure.top_level) {
      bottom.push_back(&structure);
    }
  }
  ASSERT_EQ(bottom.size(), 3u);
  EXPECT_EQ(bottom[0]->block.is_update, 0u);
  EXPECT_EQ(bottom[2]->block.is_update, 1u);
  EXPECT_EQ(bottom[0]->primitives, bottom[1]->primitives);
  EXPECT_NE(bottom[1]->primitives, bottom[2]->primitives);
}

TEST(Capture, two_structures_of_one_shader_are_told_apart_by_site) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles files = capture_of("two_tlas", folder);
  for (const CapturedDispatch& dispatch : files.dispatches) {
    ASSERT_EQ(dispatch.bindings.size(), 2u);
    const auto instances = [&](std::uint64_t id) {
      const auto found =
          std::find_if(files.structures.begin(), files.structures.end(),
                       [id](const CapturedStructure& s) { return s.block.id == id; });
      return found == files.structures.end() ? 0 : found->instances.size();
    };
    EXPECT_EQ(instances(dispatch.bindings[0].tlas_id), 1u);
    EXPECT_EQ(instances(dispatch.bindings[1].tlas_id), 2u);
  }
  EXPECT_EQ(files.dispatches[0].block.frame, files.dispatches[1].block.frame);
}

TEST(Capture, inactive_instances_keep_their_place) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles files = capture_of("instances", folder);
  std::size_t inactive = 0;
  for (const CapturedStructure& structure : files.structures) {
    for (std::size_t i = 0; i < structure.instances.size(); ++i) {
      const bool by_pointer = structure.instances[0].custom_index != 0;
      EXPECT_EQ(structure.instances[i].custom_index, by_pointer ? 13 - i : i);
      inactive += structure.instances[i].blas_address == 0 ? 1U : 0U;
    }
  }
  EXPECT_EQ(inactive, 2u);
}

TEST(Capture, copies_name_source_and_destination) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles files = capture_of("compaction", folder);
  ASSERT_EQ(files.copies.size(), 2u);
  EXPECT_EQ(files.copies[0].destination_address, files.copies[1].source_address);
  EXPECT_NE(files.copies[0].destination_id, files.copies[1].destination_id);
}

TEST(Capture, destroyed_structures_are_announced_after_their_last_use) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles files = capture_of("two_tlas", folder);
  EXPECT_EQ(files.count(BlockType::kAsDestroyed), files.structures.size());
  const auto first = std::find_if(files.blocks.begin(), files.blocks.end(),
                                  [](const Block& b) { return b.type == BlockType::kAsDestroyed; });
  EXPECT_TRUE(std::none_of(first, files.blocks.end(),
                           [](const Block& b) { return b.type == BlockType::kDispatch; }));
}

TEST(Capture, effects_of_a_foreign_program_are_in_the_manifest) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles files = capture_of("shadow", folder);
  ASSERT_EQ(files.count(BlockType::kPipeline), 1u);
  // Flags of the two trace instructions are constants: opaque; first hit without closest hit.
  std::vector<std::uint32_t> flags;
  for (const Block& block : files.blocks) {
    if (block.type != BlockType::kEffects) {
      continue;
    }
    capture::EffectsBlock effects;
    std::memcpy(&effects, block.payload.data(), sizeof(effects));
    for (std::uint32_t i = 0; i < effects.site_count; ++i) {
      capture::SiteBlock site;
      std::memcpy(&site, block.payload.data() + sizeof(effects) + i * sizeof(site), sizeof(site));
      EXPECT_EQ(site.flags_known, 1u);
      EXPECT_EQ(site.structure, 1u);
      flags.push_back(site.ray_flags);
    }
  }
  EXPECT_THAT(flags, testing::UnorderedElementsAre(1u, 4u | 8u));
}

TEST(Capture, record_kinds_and_counters_can_be_left_out) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles rays =
      capture_of("any_hit", folder, {{"A2RT_RECORDS", "rays"}, {"A2RT_COUNTERS", "0"}});
  const RecordCounts counts = count_records(rays);
  EXPECT_EQ(counts.kinds.size(), 1u);
  EXPECT_EQ(counts.kinds.at(RecordKind::kRay), kPixels);
}

TEST(Capture, fragments_that_the_depth_test_hides_trace_no_rays) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  EXPECT_EQ(count_records(capture_of("query_depth", folder)).kinds.at(RecordKind::kRay), kPixels);
  // Where early tests could show in the picture they are late, and that is said.
  const CaptureFiles covered = capture_of("query_coverage", folder);
  EXPECT_THAT(covered.refused, testing::ElementsAre(HasSubstr("alpha turned into coverage")));
}

// The rays of the program have intervals that do not overlap.
TEST(Capture, records_of_queries_alive_at_once_name_their_ray) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const CaptureFiles files = capture_of("query_alive", folder);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<float, float>> intervals;
  std::uint64_t checked = 0;
  visit_records(files, [&](const std::uint32_t* words) {
    const auto number = [&](std::size_t word) { return std::bit_cast<float>(words[word]); };
    const auto kind = static_cast<RecordKind>(words[0] & 0xffu);
    if (kind == RecordKind::kRay) {
      intervals[{words[1], words[3] + 1}] = {number(7), number(11)};
    }
    const bool has_t =
        kind == RecordKind::kQueryVerdict || (kind == RecordKind::kQueryStep && words[4] != 0);
    if (has_t) {
      const auto& [tmin, tmax] = intervals.at({words[1], words[3]});
      EXPECT_TRUE(tmin < number(5) && number(5) < tmax) << number(5) << " at ray " << words[3];
      ++checked;
    }
  });
  EXPECT_GT(checked, 2 * kPixels);
}

TEST(Capture, records_beyond_the_limit_are_counted_not_written) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const RunResult plain = run_program("any_hit", folder, false);
  const RunResult result = run_program(
      "any_hit", folder, true, {{"A2RT_CAPTURE", folder.path("capture")}, {"A2RT_LIMIT", "64K"}});
  EXPECT_TRUE(result.picture == plain.picture);
  EXPECT_THAT(result.output, HasSubstr("A2RT_LIMIT"));
  const CaptureFiles files = read_capture(folder.path("capture"));
  EXPECT_LE(files.records.size() * 4, 65536u);
  EXPECT_GT(files.end.lost_records, 0u);
}

TEST(Capture, any_hit_order_is_said_where_it_matters_and_only_there) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const Environment on = {{"A2RT_CAPTURE", folder.path("capture")}};
  const char* const kLine = "may depend on the order of traversal";
  EXPECT_THAT(run_program("any_hit_order", folder, true, on).output, HasSubstr(kLine));
  EXPECT_THAT(run_program("any_hit", folder, true, on).output, Not(HasSubstr(kLine)));
  const RunResult plain = run_program("any_hit_order", folder, false);
  const RunResult off =
      run_program("any_hit_order", folder, true,
                  {{"A2RT_CAPTURE", folder.path("capture")}, {"A2RT_REBUILD", "off"}});
  EXPECT_TRUE(off.picture == plain.picture);
  EXPECT_THAT(off.output, IsEmpty());
}

// One dispatch in which every launch has one verdict, the same for all.
void write_verdicts(const std::string& path, const capture::VerdictEntry& entry) {
  std::ofstream file(path, std::ios::binary);
  const auto put = [&file](const auto& value) {
    file.write(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  put(capture::VerdictFileHeader{capture::kVerdictMagic, capture::kFormatVersion, 1, 0});
  put(capture::VerdictDispatchHeader{0, kPixels, kPixels, 0});
  for (std::uint32_t i = 0; i < kPixels; ++i) {
    put(i);
    put(1u);
  }
  for (std::uint32_t i = 0; i < kPixels; ++i) {
    put(entry);
  }
}

constexpr auto kForceMiss = static_cast<std::uint32_t>(capture::VerdictAction::kForceMiss);
constexpr auto kInterval = static_cast<std::uint32_t>(capture::VerdictAction::kInterval);

TEST(Verdicts, forced_misses_run_the_miss_shader_everywhere) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  write_verdicts(folder.path("v"), {kForceMiss, 0, 0, 0});
  const CaptureFiles files =
      capture_of("hit_groups", folder, {{"A2RT_VERDICTS", folder.path("v")}});
  const RecordCounts counts = count_records(files);
  EXPECT_EQ(counts.kinds.at(RecordKind::kMiss), kPixels);
  EXPECT_EQ(counts.kinds.count(RecordKind::kHit), 0u);
  // The record keeps the program's own mask and says that a verdict was applied.
  EXPECT_EQ(files.records[13] & 0xffu, 0xffu);
  EXPECT_EQ(files.records[15], 1u);
}

TEST(Verdicts, an_interval_hides_what_lies_outside) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const RunResult plain = run_program("hit_groups", folder, false);
  write_verdicts(folder.path("all"), {kInterval, 0.001f, 100.0f, 0});
  write_verdicts(folder.path("near"), {kInterval, 0.001f, 2.9f, 0});
  const RunResult all =
      run_program("hit_groups", folder, true, {{"A2RT_VERDICTS", folder.path("all")}});
  const RunResult near =
      run_program("hit_groups", folder, true, {{"A2RT_VERDICTS", folder.path("near")}});
  ASSERT_EQ(near.status, 0) << near.output;
  EXPECT_TRUE(all.picture == plain.picture);
  EXPECT_FALSE(near.picture == plain.picture);
}

TEST(Verdicts, a_damaged_file_stops_the_program_with_a_reason) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  write_verdicts(folder.path("v"), {kForceMiss, 0, 0, 0});
  const std::string whole = read_text(folder.path("v"));
  const std::vector<std::string> damaged = {"", "hello, this is not one", whole.substr(0, 1000),
                                            whole + "x"};
  for (const std::string& bytes : damaged) {
    std::ofstream(folder.path("d"), std::ios::binary) << bytes;
    const RunResult result =
        run_program("hit_groups", folder, true, {{"A2RT_VERDICTS", folder.path("d")}});
    EXPECT_NE(result.status, 0);
    EXPECT_THAT(result.output, HasSubstr("verdict file"));
    EXPECT_THAT(result.picture, IsEmpty());
  }
}

TEST(Guards, another_driver_runs_untouched_with_one_line) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const RunResult plain = run_program("recursion", folder, false);
  const RunResult other =
      run_program("recursion", folder, true,
                  {{"A2RT_ASSUME_DRIVER_ID", "1"}, {"A2RT_CAPTURE", folder.path("capture")}});
  EXPECT_EQ(other.status, 0);
  EXPECT_TRUE(other.picture == plain.picture);
  EXPECT_THAT(other.output, HasSubstr("not lavapipe"));
  EXPECT_EQ(std::count(other.output.begin(), other.output.end(), '\n'), 1);
  EXPECT_FALSE(file_exists(folder.path("capture")));
}

TEST(Guards, a_shader_whose_workgroup_size_is_unknown_runs_as_it_is) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const RunResult plain = run_program("query_opaque_size", folder, false);
  const RunResult result =
      run_program("query_opaque_size", folder, true, {{"A2RT_CAPTURE", folder.path("capture")}});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.picture == plain.picture);
  EXPECT_THAT(result.output, HasSubstr("workgroup size of compute shader 'main'"));
  EXPECT_THAT(result.output, HasSubstr("no capture in " + folder.path("capture")));
}

TEST(Guards, settings_that_are_not_understood_are_named_each_on_one_line) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const RunResult result =
      run_program("hit_groups", folder, true, {{"A2RT_REBUILD", "fast"}, {"A2RT_CAPTRUE", "x"}});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("A2RT_REBUILD=\"fast\" is not understood"));
  EXPECT_THAT(result.output, HasSubstr("A2RT_CAPTRUE is unknown"));
  EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 2);
}

TEST(Guards, a_capture_that_cannot_be_made_stops_the_program) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  std::ofstream(folder.path("file")) << "in the way";
  const RunResult result =
      run_program("hit_groups", folder, true, {{"A2RT_CAPTURE", folder.path("file")}});
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr(folder.path("file")));
}

TEST(Guards, a_folder_that_another_process_captures_into_is_left_alone) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const std::string capture = folder.path("capture");
  std::filesystem::create_directory(capture);
  const RunResult plain = run_program("hit_groups", folder, false);
  // This process stands for the other one.
  auto other = std::make_unique<layer::CaptureLock>(capture);
  const RunResult second = run_program("hit_groups", folder, true, {{"A2RT_CAPTURE", capture}});
  EXPECT_EQ(second.status, 0);
  EXPECT_TRUE(second.picture == plain.picture);
  EXPECT_THAT(second.output, HasSubstr("belongs to another process"));
  EXPECT_EQ(std::count(second.output.begin(), second.output.end(), '\n'), 1);
  EXPECT_TRUE(std::filesystem::is_empty(capture));
  other.reset();
  EXPECT_EQ(capture_of("hit_groups", folder).dispatches.size(), 1u);
}

TEST(Guards, nothing_that_looks_complete_is_left_of_a_program_that_dies) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const std::string capture = folder.path("capture");
  // An older capture in the same place must not be taken for the new one.
  capture_of("hit_groups", folder);
  ASSERT_TRUE(file_exists(capture + "/manifest.bin"));
  const RunResult result = run_program("crash", folder, true, {{"A2RT_CAPTURE", capture}});
  EXPECT_NE(result.status, 0);
  EXPECT_FALSE(file_exists(capture + "/manifest.bin"));
  EXPECT_FALSE(file_exists(capture + "/records.bin"));
}

TEST(Guards, on_a_full_disk_the_program_goes_on_and_no_capture_is_left) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const std::string capture = folder.path("capture");
  const RunResult plain = run_program("full_disk", folder, false);
  const RunResult result = run_program("full_disk", folder, true, {{"A2RT_CAPTURE", capture}});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.picture == plain.picture);
  EXPECT_THAT(result.output, HasSubstr("cannot write " + capture + "/records.bin.part"));
  EXPECT_THAT(result.output, HasSubstr("free space there"));
  EXPECT_THAT(result.output, HasSubstr("no capture in " + capture));
  EXPECT_TRUE(std::filesystem::is_empty(capture));
}

TEST(Guards, a_second_device_at_the_same_time_is_left_out_and_said) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const RunResult plain = run_program("two_devices", folder, false);
  const RunResult result =
      run_program("two_devices", folder, true, {{"A2RT_CAPTURE", folder.path("capture")}});
  EXPECT_TRUE(result.picture == plain.picture);
  EXPECT_THAT(result.output, HasSubstr("a second device at the same time"));
  const CaptureFiles files = read_capture(folder.path("capture"));
  EXPECT_EQ(files.dispatches.size(), 1u);
  EXPECT_EQ(count_records(files).kinds.at(RecordKind::kRay), kPixels);
}

TEST(Guards, a_later_device_does_not_replace_the_capture_of_an_earlier_one) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const RunResult plain = run_program("any_hit+hit_groups", folder, false);
  const RunResult result =
      run_program("any_hit+hit_groups", folder, true, {{"A2RT_CAPTURE", folder.path("capture")}});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.picture == plain.picture);
  EXPECT_THAT(result.output, HasSubstr("holds the capture of an earlier device"));
  EXPECT_EQ(count_records(read_capture(folder.path("capture"))).kinds.count(RecordKind::kAnyHit),
            1u);
}

TEST(Guards, a_program_that_leaves_without_destroying_its_device_is_captured) {
  NEEDS_LAVAPIPE();
  const Folder folder;
  const std::string capture = folder.path("capture");
  const RunResult result = run_program("early_exit", folder, true, {{"A2RT_CAPTURE", capture}});
  EXPECT_EQ(result.status, 0) << result.output;
  const CaptureFiles files = read_capture(capture);
  EXPECT_EQ(count_records(files).kinds.at(RecordKind::kRay), kPixels);
}

}  // namespace
}  // namespace a2rt::test
