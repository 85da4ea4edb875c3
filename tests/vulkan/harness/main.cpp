// vulkan_programs PROGRAM[+PROGRAM...] PICTURE.ppm: runs one program after the other, each on a
// device of its own, and writes what the last one drew. vulkan_programs --list: the programs'
// names.
#include <cstdio>
#include <exception>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "harness/app.h"

namespace {

void write_picture(const foreign::Buffer& picture, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << foreign::kWidth << " " << foreign::kHeight << "\n255\n";
  const auto bytes = picture.as<const unsigned char>();
  for (std::size_t pixel = 0; pixel < bytes.size() / 4; ++pixel) {
    file.write(reinterpret_cast<const char*>(&bytes[pixel * 4]), 3);
  }
  if (!file) {
    throw std::runtime_error("cannot write " + path);
  }
}

// Empty if one of the names is unknown.
std::vector<foreign::Run> find_programs(const std::string& names) {
  std::vector<foreign::Run> runs;
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, '+');) {
    const auto found = foreign::programs().find(name);
    if (found == foreign::programs().end()) {
      return {};
    }
    runs.push_back(found->second);
  }
  return runs;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--list") {
    for (const auto& [name, run] : foreign::programs()) {
      std::printf("%s\n", name.c_str());
    }
    return 0;
  }
  const auto runs = argc == 3 ? find_programs(argv[1]) : std::vector<foreign::Run>{};
  if (runs.empty()) {
    std::fprintf(stderr, "usage: %s PROGRAM[+PROGRAM...] PICTURE.ppm | --list\n", argv[0]);
    return 2;
  }
  try {
    for (const foreign::Run run : runs) {
      foreign::App app;
      run(app);
      write_picture(app.picture(), argv[2]);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[1], error.what());
    return 1;
  }
  return 0;
}
