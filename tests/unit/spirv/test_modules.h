// The modules that the build compiled for these tests, and a validator to ask.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace a2rt::spirv::testing {

struct TestModule {
  std::string name;  // e.g. "raygen.rgen.v12"
  std::vector<std::uint32_t> words;
};

const std::vector<TestModule>& all_modules();
const std::vector<std::uint32_t>& module_named(std::string_view name);

// What spirv-val says; empty if it accepts the module.
std::string validation_error(const std::vector<std::uint32_t>& words, const std::string& name);

}  // namespace a2rt::spirv::testing
