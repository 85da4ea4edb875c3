#include "program.h"

#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

namespace a2rt::test {

Outcome run_program(const std::string& arguments, const std::string& environment) {
  const std::string command =
      environment + " " + std::string(A2RT_RENDER) + " " + arguments + " 2>&1";
  Outcome run;
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
    run.output.append(buffer, n);
  }
  const int status = pclose(pipe);
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

std::string why_no_device() {
  const TemporaryFolder folder;
  const auto quad = folder.write("quad.gltf", QuadFile{}.text());
  const Outcome run = run_program(quad.string() + " --size 1x1 --spp 1 -q");
  return run.status == 0 ? "" : run.output;
}

std::vector<float> read_pfm(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string magic;
  std::size_t width = 0, height = 0;
  double scale = 0;
  in >> magic >> width >> height >> scale;
  in.get();
  std::vector<float> rgb(magic == "PF" ? width * height * 3 : 0);
  in.read(reinterpret_cast<char*>(rgb.data()), static_cast<std::streamsize>(rgb.size() * 4));
  return rgb;
}

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace a2rt::test
