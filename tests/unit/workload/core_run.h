// Runs a2rt-core as a user does and keeps what it printed.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace a2rt::testing {

struct CoreRun {
  int status = -1;
  std::string output;
};

// `environment`: assignments in the shell's form, before the program's name.
inline CoreRun run_core(const std::string& arguments, const std::string& environment = "") {
  CoreRun run;
  const std::string command = environment + " " A2RT_CORE_BINARY " " + arguments + " 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  std::array<char, 4096> part;
  while (pipe != nullptr && std::fgets(part.data(), part.size(), pipe) != nullptr) {
    run.output += part.data();
  }
  const int status = pipe == nullptr ? -1 : ::pclose(pipe);
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

}  // namespace a2rt::testing
