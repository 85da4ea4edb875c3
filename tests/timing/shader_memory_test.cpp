// Addresses of shader loads and stores: the lines of a warp's access against its lanes' bytes.
#include "a2rt/timing/shader_memory.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

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

}  // namespace
}  // namespace a2rt::timing::test
