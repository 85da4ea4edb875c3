#include "test_modules.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace a2rt::spirv::testing {
namespace {

std::vector<std::uint32_t> read_words(const std::filesystem::path& path) {
  std::vector<std::uint32_t> words(std::filesystem::file_size(path) / 4);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(words.size() * 4));
  return words;
}

std::vector<TestModule> read_all() {
  std::vector<TestModule> modules;
  for (const auto& entry : std::filesystem::directory_iterator(A2RT_TEST_MODULES)) {
    if (entry.path().extension() == ".spv") {
      modules.push_back({entry.path().stem().string(), read_words(entry.path())});
    }
  }
  std::ranges::sort(modules, {}, &TestModule::name);
  return modules;
}

}  // namespace

const std::vector<TestModule>& all_modules() {
  static const std::vector<TestModule> modules = read_all();
  return modules;
}

const std::vector<std::uint32_t>& module_named(std::string_view name) {
  const auto found = std::ranges::find(all_modules(), name, &TestModule::name);
  if (found == all_modules().end()) {
    throw std::runtime_error("no test module " + std::string(name));
  }
  return found->words;
}

std::string validation_error(const std::vector<std::uint32_t>& words, const std::string& name) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("a2rt-" + std::to_string(getpid()) + "-" + name + ".spv");
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(words.data()),
             static_cast<std::streamsize>(words.size() * 4));
  const std::string command = std::string(A2RT_SPIRV_VAL) +
                              " --target-env vulkan1.3 --scalar-block-layout " + path.string() +
                              " 2>&1";
  std::string said;
  std::FILE* const pipe = popen(command.c_str(), "r");
  std::array<char, 512> line{};
  while (std::fgets(line.data(), line.size(), pipe) != nullptr) {
    said += line.data();
  }
  const int status = pclose(pipe);
  std::filesystem::remove(path);
  return status == 0 ? std::string{} : said + "(status " + std::to_string(status) + ")";
}

}  // namespace a2rt::spirv::testing
