// vulkan_programs PROGRAM PICTURE.ppm: runs one program and writes what it drew.
// vulkan_programs --list: the programs' names.
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

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

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--list") {
    for (const auto& [name, run] : foreign::programs()) {
      std::printf("%s\n", name.c_str());
    }
    return 0;
  }
  const auto found = argc == 3 ? foreign::programs().find(argv[1]) : foreign::programs().end();
  if (found == foreign::programs().end()) {
    std::fprintf(stderr, "usage: %s PROGRAM PICTURE.ppm | --list\n", argv[0]);
    return 2;
  }
  try {
    foreign::App app;
    found->second(app);
    write_picture(app.picture(), argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[1], error.what());
    return 1;
  }
  return 0;
}
