#include "layer_run.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace a2rt::test {

Folder::Folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "a2rt-layer-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw std::runtime_error("cannot make a temporary folder");
  }
  path_ = pattern;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool file_exists(const std::string& path) { return std::filesystem::exists(path); }

namespace {

// Replaces this process; `environment` is added to what it has.
[[noreturn]] void become(const std::string& program, const std::string& picture,
                         const std::string& log, bool layer, const Environment& environment) {
  for (const char* name : {"A2RT_CAPTURE", "A2RT_VERDICTS", "A2RT_REBUILD", "A2RT_COUNTERS",
                           "A2RT_RECORDS", "A2RT_LIMIT", "A2RT_LOG", "VK_INSTANCE_LAYERS"}) {
    ::unsetenv(name);
  }
  if (layer) {
    ::setenv("VK_LAYER_PATH", A2RT_LAYER_FOLDER, 1);
    ::setenv("VK_INSTANCE_LAYERS", "VK_LAYER_A2RT_capture", 1);
  }
  for (const auto& [name, value] : environment) {
    ::setenv(name.c_str(), value.c_str(), 1);
  }
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ::dup2(file, STDERR_FILENO);
  ::execl(A2RT_PROGRAMS, A2RT_PROGRAMS, program.c_str(), picture.c_str(), nullptr);
  ::_exit(127);
}

}  // namespace

RunResult run_program(const std::string& program, const Folder& folder, bool layer,
                      const Environment& environment) {
  const std::string picture = folder.path("picture.ppm");
  const std::string log = folder.path("stderr.txt");
  std::filesystem::remove(picture);
  const pid_t child = ::fork();
  if (child == 0) {
    become(program, picture, log, layer, environment);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  RunResult result;
  result.peak_bytes = std::int64_t{usage.ru_maxrss} * 1024;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.output = read_text(log);
  result.picture = read_text(picture);
  return result;
}

}  // namespace a2rt::test
