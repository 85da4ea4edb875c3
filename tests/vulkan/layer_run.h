// Runs a test program as a user would: its own process, the layer chosen by the environment.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace a2rt::test {

struct RunResult {
  int status = -1;              // exit status; 128 + signal if a signal ended it
  std::string output;           // stderr
  std::string picture;          // bytes of the picture file; empty if there is none
  std::int64_t peak_bytes = 0;  // most memory it had at once, mapped files included
};

class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string path(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

using Environment = std::map<std::string, std::string>;

// `layer` false: without the layer.
RunResult run_program(const std::string& program, const Folder& folder, bool layer,
                      const Environment& environment = {});

std::string read_text(const std::string& path);
bool file_exists(const std::string& path);

}  // namespace a2rt::test
