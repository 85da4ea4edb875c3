// Every rewritten module is valid SPIR-V wherever the original is.
#include <gtest/gtest.h>

#include "spirv/instrument.h"
#include "spirv/module.h"
#include "test_modules.h"

namespace a2rt::spirv {
namespace {

using testing::all_modules;
using testing::validation_error;

InstrumentOptions everything() {
  InstrumentOptions options;
  options.header_address = 0x500000000040;
  return options;
}

TEST(Validation, RewrittenModulesAreValid) {
  std::size_t validated = 0;
  for (const auto& module : all_modules()) {
    const InstrumentResult result = instrument(module.words, everything());
    if (!result.instrumented) {
      continue;
    }
    const std::string error = validation_error(result.words, module.name);
    if (error.empty()) {
      ++validated;
      continue;
    }
    // glslang's own debug information is sometimes wrong; then the original fails alike.
    EXPECT_FALSE(validation_error(module.words, module.name).empty())
        << module.name << ": " << error;
  }
  EXPECT_GE(validated, 60u);
}

TEST(Validation, EachFeatureAloneGivesAValidModule) {
  constexpr bool InstrumentOptions::*kFeatures[] = {
      &InstrumentOptions::rays, &InstrumentOptions::results, &InstrumentOptions::candidates,
      &InstrumentOptions::counters, &InstrumentOptions::verdicts};
  for (const auto feature : kFeatures) {
    InstrumentOptions options{.header_address = 1 << 20,
                              .rays = false,
                              .results = false,
                              .candidates = false,
                              .counters = false,
                              .verdicts = false};
    options.*feature = true;
    for (const auto& module : all_modules()) {
      if (module.name.ends_with(".v12") || module.name.ends_with(".asm")) {
        const InstrumentResult result = instrument(module.words, options);
        EXPECT_EQ(validation_error(result.words, module.name), "") << module.name;
      }
    }
  }
}

TEST(Validation, AModuleCanBeInstrumentedTwice) {
  const InstrumentResult once = instrument(testing::module_named("raygen.rgen.v12"), everything());
  const InstrumentResult twice = instrument(once.words, everything());
  EXPECT_TRUE(twice.instrumented);
  EXPECT_EQ(validation_error(twice.words, "twice"), "");
}

}  // namespace
}  // namespace a2rt::spirv
