// Units by name and by file, as the commands of a2rt-core take them: which parameters are used, and
// what is said of a unit that there is not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "a2rt/workload/file.h"
#include "a2rt/workload/synthetic.h"
#include "workload/core_run.h"
#include "workload/scratch_folder.h"

namespace a2rt {
namespace {

using ::testing::HasSubstr;

using testing::CoreRun;

class UnitOption : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void put(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    std::ofstream(path(name)) << text;
  }
  // a2rt-core with the scratch folder as its folder of configurations.
  CoreRun run(const std::string& arguments) const {
    return testing::run_core(arguments, "A2RT_CONFIGS='" + folder_.path().string() + "'");
  }
  std::string refused(const std::string& arguments) const {
    const CoreRun outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("a2rt, a2rt-literal, aqb8, baseline"));
    return outcome.output;
  }
  std::string small_workload() const {
    synthetic::Config config;
    config.primitives = 50;
    config.width = config.height = 8;
    write_workload(synthetic::make(config), path("w.h5"));
    return path("w.h5");
  }
  std::uint64_t benched_node_bytes(const std::string& unit) const {
    const CoreRun outcome = run("bench-units " + path("w.h5") + " --repeats 1 --units " + unit +
                                " -o " + path("bench.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    std::ifstream file(path("bench.json"));
    return nlohmann::json::parse(file).at("units").at(0).at("node_bytes").get<std::uint64_t>();
  }

  testing::ScratchFolder folder_;
};

TEST_F(UnitOption, AFileThatNamesAnUnknownUnitIsRefusedWithItsPlace) {
  put("my.toml", "# mine\n  unit = \"nonsense\"\n");
  const std::string message = refused("units " + path("my.toml"));
  EXPECT_THAT(message, HasSubstr(path("my.toml") + ":2:"));
  EXPECT_THAT(message, HasSubstr("unit is \"nonsense\", must be one of"));
}

TEST_F(UnitOption, AFileWhoseNameIsNoUnitIsToldToNameOne) {
  put("my.toml", "[tree]\nmax_leaf = 2\n");
  const std::string message = refused("units " + path("my.toml"));
  EXPECT_THAT(message, HasSubstr(path("my.toml") + ": no RT unit is called 'my'"));
  EXPECT_THAT(message, HasSubstr("unit = one of"));
}

TEST_F(UnitOption, AConfigurationOfAnUnregisteredUnitIsRefusedWithItsFile) {
  put("units/ghost.toml", "");
  EXPECT_THAT(refused("units ghost"), HasSubstr("ghost.toml: no RT unit is called 'ghost'"));
}

TEST_F(UnitOption, AnUnknownNameIsRefusedWithTheKnownOnes) {
  const std::string message = refused("units nonsense");
  EXPECT_THAT(message, HasSubstr("no RT unit named 'nonsense'; known: "));
  EXPECT_THAT(message, HasSubstr("or give a .toml file"));
}

TEST_F(UnitOption, BenchUnitsTakesTheParametersOfTheConfiguration) {
  small_workload();
  put("units/baseline.toml", "[layout]\nnode_bytes = 56\n");
  const std::uint64_t narrow = benched_node_bytes("baseline");
  put("units/baseline.toml", "[layout]\nnode_bytes = 112\n");
  EXPECT_EQ(benched_node_bytes("baseline"), 2 * narrow);
  put("other.toml", "unit = \"baseline\"\n[layout]\nnode_bytes = 168\n");
  EXPECT_EQ(benched_node_bytes(path("other.toml")), 3 * narrow);
  EXPECT_THAT(refused("bench-units " + path("w.h5") + " --units nonsense"),
              HasSubstr("no RT unit named 'nonsense'"));
}

}  // namespace
}  // namespace a2rt
