#include "layer/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace a2rt::layer {
namespace {

TEST(Settings, every_value_that_is_not_understood_is_named_and_changes_nothing) {
  const std::vector<std::string> bad = {"A2RT_REBUILD=",        "A2RT_REBUILD=SAH",
                                        "A2RT_COUNTERS=yes",    "A2RT_RECORDS=hits",
                                        "A2RT_RECORDS=results", "A2RT_LIMIT=12Q",
                                        "A2RT_LIMIT=0",         "A2RT_LIMIT=-1",
                                        "A2RT_LOG=loud",        "A2RT_MEMORY=99999999999999999999G",
                                        "A2RT_SITE_LIMIT=x"};
  const Settings defaults;
  for (const std::string& line : bad) {
    std::vector<std::string> problems;
    const Settings settings = read_settings({line}, problems);
    ASSERT_EQ(problems.size(), 1u) << line;
    EXPECT_THAT(problems[0], testing::HasSubstr(line.substr(0, line.find('='))));
    EXPECT_EQ(settings.rebuild, defaults.rebuild);
    EXPECT_EQ(settings.counters, defaults.counters);
    EXPECT_EQ(settings.limit_bytes, defaults.limit_bytes);
    EXPECT_EQ(settings.memory_bytes, defaults.memory_bytes);
  }
}

TEST(Settings, good_values_are_taken_without_a_word) {
  std::vector<std::string> problems;
  const Settings settings = read_settings(
      {"A2RT_CAPTURE=/x", "A2RT_REBUILD=off", "A2RT_COUNTERS=0", "A2RT_RECORDS=rays,candidates",
       "A2RT_LIMIT=3G", "A2RT_MEMORY=64M", "A2RT_LOG=debug", "HOME=/root", "A2RT_PROGRESS=1"},
      problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(settings.capture_directory, "/x");
  EXPECT_FALSE(settings.rebuild);
  EXPECT_FALSE(settings.counters);
  EXPECT_TRUE(settings.records.rays);
  EXPECT_FALSE(settings.records.results);
  EXPECT_TRUE(settings.records.candidates);
  EXPECT_EQ(settings.limit_bytes, std::uint64_t{3} << 30);
  EXPECT_EQ(settings.memory_bytes, std::uint64_t{64} << 20);
}

}  // namespace
}  // namespace a2rt::layer
