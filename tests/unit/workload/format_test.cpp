// The Python example of FORMAT.md runs on a file of today's writer and says what is in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>

#include "a2rt/workload/file.h"
#include "a2rt/workload/synthetic.h"
#include "scratch_folder.h"

namespace a2rt {
namespace {

using ::testing::HasSubstr;

std::string output_of(const std::string& command) {
  std::string output;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen((command + " 2>&1").c_str(), "r"),
                                                   ::pclose);
  std::array<char, 4096> part;
  while (pipe && std::fgets(part.data(), part.size(), pipe.get()) != nullptr) {
    output += part.data();
  }
  return output;
}

// A Python with h5py: the one named by A2RT_PYTHON, or one of the usual names.
std::string python() {
  const char* named = std::getenv("A2RT_PYTHON");
  for (const std::string candidate : {named != nullptr ? named : "", "python3", A2RT_PYTHON_HINT}) {
    if (!candidate.empty() &&
        output_of(candidate + " -c 'import h5py; print(\"yes\")'") == "yes\n") {
      return candidate;
    }
  }
  return "";
}

std::string example() {
  std::ifstream in(A2RT_FORMAT_MD);
  std::ostringstream text;
  text << in.rdbuf();
  const std::string all = text.str();
  const std::string mark = "```python\n";
  const auto begin = all.find(mark) + mark.size();
  return all.substr(begin, all.find("```", begin) - begin);
}

TEST(FormatDocument, ItsPythonExampleReadsOurFiles) {
  const std::string interpreter = python();
  if (interpreter.empty()) {
    GTEST_SKIP() << "no Python with h5py; set A2RT_PYTHON to one";
  }
  const testing::ScratchFolder folder;
  synthetic::Config config;
  config.primitives = 123;
  config.width = config.height = 8;
  const Workload w = synthetic::make(config);
  std::size_t hits = 0;
  for (const Hit& hit : w.driver_hits) {
    hits += hit.state == HitState::kMiss ? 0 : 1;
  }
  write_workload(w, folder.path() / "w.h5");
  std::ofstream(folder.path() / "example.py") << example();
  const std::string output = output_of(interpreter + " " + (folder.path() / "example.py").string() +
                                       " " + (folder.path() / "w.h5").string());
  EXPECT_THAT(output, HasSubstr("rays 192\n"));
  EXPECT_THAT(output, HasSubstr("hit " + std::to_string(hits) + "\n"));
  EXPECT_THAT(output, HasSubstr("primary 64\n"));
  EXPECT_THAT(output, HasSubstr("triangles 123\n"));
  EXPECT_THAT(output, HasSubstr("bounds [-"));
}

}  // namespace
}  // namespace a2rt
