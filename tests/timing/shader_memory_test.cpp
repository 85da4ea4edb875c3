// Addresses of shader loads and stores: the lines of a warp's access against its lanes' bytes.
#include "a2rt/timing/shader_memory.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "mocks.h"

namespace a2rt::timing::test {
namespace {

using Lines = std::map<std::uint64_t, SectorMask>;

struct ShaderMemoryTest : ::testing::TestWithParam<std::uint32_t> {
  std::mt19937 engine{GetParam()};
  std::uint32_t random() { return static_cast<std::uint32_t>(engine()); }
  std::uint32_t words = GetParam(), ordinal = random() % 100;
  LaneAddresses lanes;
  Workload workload;
  MachineConfig config;
  ShaderMemoryTest() {
    config.sm.words_per_load = words;
    lanes.lanes = (random() & random()) | 1;
    lanes.width = 100;
    lanes.first_launch = 5 * lanes.width + random() % 60;
    lanes.thread_block = 7;
  }
  // The sectors of `bytes` at the place of each of the lanes.
  template <class Place>
  static Lines touched(std::uint32_t mask, std::uint64_t bytes, const Place& place) {
    Lines all;
    for_each_bit(mask, [&](std::uint32_t l) {
      for (std::uint64_t b = 0; b < bytes; ++b) {
        const Address at{place(l) + b};
        all[line_of(at)] = static_cast<SectorMask>(all[line_of(at)] | 1u << sector_index(at));
      }
    });
    return all;
  }
  Lines lines(ShaderAccess access) const {
    Lines all;
    ShaderAddresses(workload, config)
        .lines(access, ordinal, lanes, [&](std::uint64_t line, SectorMask sectors) {
          EXPECT_TRUE(all.empty() || all.rbegin()->first < line);
          EXPECT_NE(sectors, 0);
          all[line] = sectors;
        });
    return all;
  }
  std::uint64_t launch(std::uint32_t lane) const { return lanes.first_launch + lane; }
};

INSTANTIATE_TEST_SUITE_P(WordsPerLoad, ShaderMemoryTest,
                         ::testing::Values(1u, 2u, 3u, 4u, 8u, 31u, 100u));

TEST_P(ShaderMemoryTest, streams_hold_16_bytes_a_launch_id) {
  const std::uint64_t base = (std::uint64_t{1} << 47) + (std::uint64_t{ordinal} << 32);
  const auto place = [&](std::uint32_t l) { return base + launch(l) * 16; };
  EXPECT_EQ(lines(ShaderAccess::kBufferLoad), touched(lanes.lanes, words * 4, place));
  EXPECT_EQ(lines(ShaderAccess::kBufferStore), touched(lanes.lanes, 16, place));
}

TEST_P(ShaderMemoryTest, hits_read_their_record_then_the_material) {
  lanes.records = 3;
  lanes.record = {4, 9, 10};
  lanes.by_hit = lanes.lanes & static_cast<std::uint32_t>(random());
  lanes.by_hit |= 1;
  for (ordinal = 0; ordinal < 40; ++ordinal) {
    const std::uint64_t bytes = words * 4, offset = ordinal * bytes;
    Lines expected = touched(lanes.lanes & ~lanes.by_hit, bytes, [&](std::uint32_t l) {
      return (std::uint64_t{1} << 47) + (std::uint64_t{ordinal} << 32) + launch(l) * 16;
    });
    expected.merge(
        offset + bytes <= 128
            ? touched(7, bytes,
                      [&](std::uint32_t r) {
                        return (std::uint64_t{1} << 45) + lanes.record[r] * 128 + offset;
                      })
            : touched(1, bytes, [&](std::uint32_t) { return (std::uint64_t{1} << 46) + offset; }));
    EXPECT_EQ(lines(ShaderAccess::kBufferLoad), expected);
  }
}

TEST_P(ShaderMemoryTest, texels_lie_in_tiles) {
  EXPECT_EQ(lines(ShaderAccess::kTexture), touched(lanes.lanes, 4, [&](std::uint32_t l) {
              const std::uint64_t x = launch(l) % lanes.width, y = launch(l) / lanes.width;
              return (std::uint64_t{1} << 48) + (std::uint64_t{ordinal} << 28) +
                     (y / 4 * 13 + x / 8) * 128 + y % 4 * 32 + x % 8 * 4;
            }));
}

TEST_P(ShaderMemoryTest, payload_words_are_interleaved_by_lane) {
  Lines expected;
  for (std::uint32_t w = 0; w < words; ++w) {
    expected.merge(touched(lanes.lanes, 4, [&](std::uint32_t l) {
      return (std::uint64_t{1} << 49) + (7 * 64 + (ordinal * words + w) % 64) * 128 + l * 4;
    }));
  }
  EXPECT_EQ(lines(ShaderAccess::kPayload), expected);
}

// Rays of one warp that hit primitives in two BLASes in any order, or miss.
struct Records : ShaderMemoryTest {
  static constexpr std::uint32_t kFirstOfSecond =
      50;  // record of the second BLAS's first primitive
  std::set<std::uint32_t> records;
  std::uint32_t by_hit = 0;
  Records() {
    workload = rays_only(kLanes);
    workload.shaders = {shader(capture::Stage::kRayGeneration), shader(capture::Stage::kClosestHit),
                        shader(capture::Stage::kMiss)};
    workload.blas.resize(2);
    workload.blas[0].triangles.resize(kFirstOfSecond);
    workload.blas[0].geometries = {{0, 20, true}, {20, 30, true}};
    workload.blas[1].triangles.resize(40);
    workload.blas[1].geometries = {{0, 40, true}};
    workload.tlas.resize(1);
    workload.tlas[0].instances.resize(2);
    workload.tlas[0].instances[0].blas = 1;
    workload.tlas[0].instances[1].blas = 0;
    for (std::uint32_t l = 0; l < kLanes; ++l) {
      Hit& hit = workload.driver_hits[l];
      hit.instance = random() % 2;
      hit.geometry = hit.instance == 0 ? 0 : random() % 2;
      hit.primitive = random() % 8;  // few, so that lanes share them
      hit.state = random() % 4 == 0 ? HitState::kMiss : HitState::kHit;
      workload.segments.push_back(segment(l, 0, {}, l));
      if (hit.state == HitState::kHit && (lanes.lanes >> l & 1) != 0) {
        by_hit |= 1u << l;
        records.insert(hit.instance == 0 ? kFirstOfSecond + hit.primitive
                                         : hit.geometry * 20 + hit.primitive);
      }
    }
    workload.dispatches[0].segment_count = workload.segments.size();
  }
  // What a shader's lanes find once their rays are back.
  void find(std::uint32_t in_shader) {
    const DispatchProgram program(workload, 0);
    WarpProgram warp(workload, program, 0, kLanes);
    SegmentWork work;
    LaneRays rays;
    ASSERT_TRUE(warp.next(work, rays));
    ShaderAddresses(workload, config).find_records(in_shader, warp, lanes);
  }
  Lines streamed(std::uint32_t mask) const {
    const std::uint64_t bytes = words * 4;
    return touched(mask, bytes, [&](std::uint32_t l) {
      return (std::uint64_t{1} << 47) + (std::uint64_t{ordinal} << 32) + launch(l) * 16;
    });
  }
};

INSTANTIATE_TEST_SUITE_P(WordsPerLoad, Records, ::testing::Values(1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u));

TEST_P(Records, of_all_hits_are_found_once_each_and_lanes_without_a_hit_stream) {
  find(1);
  EXPECT_EQ(lanes.by_hit, by_hit);
  EXPECT_EQ(std::vector<std::uint32_t>(lanes.record.begin(), lanes.record.begin() + lanes.records),
            std::vector<std::uint32_t>(records.begin(), records.end()));
  ordinal = 1;
  Lines expected = streamed(lanes.lanes & ~by_hit);
  for (const std::uint32_t record : records) {
    expected.merge(touched(1, words * 4, [&](std::uint32_t) {
      return (std::uint64_t{1} << 45) + record * 128 + words * 4;
    }));
  }
  EXPECT_EQ(lines(ShaderAccess::kBufferLoad), expected);
}

TEST_P(Records, are_nothing_to_a_shader_that_works_on_no_hit) {
  for (const std::uint32_t other : {0u, 2u, 3u}) {
    find(other);
    EXPECT_EQ(lanes.by_hit, 0u);
    EXPECT_EQ(lines(ShaderAccess::kBufferLoad), streamed(lanes.lanes));
  }
}

TEST_P(Records, are_not_read_where_every_load_streams) {
  config.shader_memory = ShaderMemory::kStreaming;
  find(1);
  EXPECT_EQ(lanes.by_hit, 0u);
  EXPECT_EQ(lanes.records, 0u);
  EXPECT_EQ(lines(ShaderAccess::kBufferLoad), streamed(lanes.lanes));
}

}  // namespace
}  // namespace a2rt::timing::test
