// One unit on many machines: what it prints is what single runs print.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "a2rt/workload/file.h"
#include "a2rt/workload/synthetic.h"
#include "workload/core_run.h"
#include "workload/scratch_folder.h"

namespace a2rt {
namespace {

using ::testing::HasSubstr;

class Vary : public ::testing::Test {
 protected:
  Vary() {
    synthetic::Config config;
    config.primitives = 200;
    config.width = config.height = 16;
    write_workload(synthetic::make(config), path("w.h5"));
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  nlohmann::json result(const std::string& command) const {
    const testing::CoreRun outcome = testing::run_core(command + " -o " + path("r.json"), "");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    std::ifstream file(path("r.json"));
    return nlohmann::json::parse(file);
  }
  std::string refused(const std::string& vary) const {
    const testing::CoreRun outcome = testing::run_core("vary " + path("w.h5") + vary, "");
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    return outcome.output;
  }

  testing::ScratchFolder folder_;
};

TEST_F(Vary, EveryMachineTakesTheCyclesAndEnergyOfARunOfItsOwn) {
  const std::string rest = " " + path("w.h5") + " --unit a2rt --set rt.stack_entries=3";
  const nlohmann::json table =
      result("vary" + rest + " --vary l1.capacity=4096,65536 --vary model=queued,reserved");
  ASSERT_EQ(table.at("runs").size(), 4u);
  for (const nlohmann::json& run : table.at("runs")) {
    std::string settings;
    for (const auto& [key, value] : run.at("set").items()) {
      settings += " --set " + key + "=" + value.get<std::string>();
    }
    const nlohmann::json alone = result("simulate" + rest + settings);
    EXPECT_EQ(run.at("time").at("cycles"), alone.at("time").at("cycles")) << settings;
    EXPECT_EQ(run.at("energy"), alone.at("energy")) << settings;
  }
  EXPECT_EQ(table.at("runs").at(0).at("set").at("l1.capacity"), "4096");
  EXPECT_EQ(table.at("runs").at(1).at("set").at("model"), "reserved");
  EXPECT_EQ(table.at("runs").at(0).at("speedup"), 1.0);
}

TEST_F(Vary, AParameterOfTheUnitIsRefusedWithTheWayToDoIt) {
  const std::string message = refused(" --vary precision.box_bits=6,8");
  EXPECT_THAT(message, HasSubstr("precision.box_bits is no parameter of the machine"));
  EXPECT_THAT(message, HasSubstr("--set"));
}

TEST_F(Vary, WhatIsNoListOfValuesIsRefused) {
  for (const char* text : {"rt.warps", "rt.warps=", "=4", "rt.warps=4,,8", "rt.warps=4,"}) {
    EXPECT_THAT(refused(std::string(" --vary ") + text), HasSubstr("--vary")) << text;
  }
}

TEST_F(Vary, ACountThatTheComparisonDecidesIsRefusedUnlessTheConfigurationDecides) {
  const std::string counts = " --unit a2rt --vary rt.testers.box.count=16,32";
  EXPECT_THAT(refused(counts), HasSubstr("rt.testers.box.count has no effect"));
  const nlohmann::json table = result("vary " + path("w.h5") + counts + " --compare-counts config");
  EXPECT_EQ(table.at("runs").at(1).at("config").at("gpu.rt.testers.box.count"), 32);
}

TEST_F(Vary, AMachineThatCannotBeIsFoundBeforeTheFirstRun) {
  const std::string message = refused(" --vary sm.count=8,16");
  EXPECT_THAT(message, HasSubstr("leaves an RT unit without one"));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("cycles")));
}

TEST_F(Vary, AMisspeltKeyIsFoundBeforeTheFirstRun) {
  const std::string message = refused(" --vary rt.warps=4,8 --vary l1.latencyy=20,40");
  EXPECT_THAT(message, HasSubstr("did you mean 'latency'"));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("cycles")));
}

}  // namespace
}  // namespace a2rt
