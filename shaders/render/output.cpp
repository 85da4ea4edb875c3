#include "render/output.h"

#include <stb/stb_image_write.h>
#include <unistd.h>

#include <fstream>

#include "a2rt/base/error.h"

namespace a2rt::render {

void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write) {
  std::filesystem::path temporary = file;
  temporary += ".part" + std::to_string(getpid());
  try {
    write(temporary);
    std::filesystem::rename(temporary, file);
  } catch (const std::exception& e) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw UserError("cannot write " + file.string() + ": " + e.what());
  }
}

void write_png(const std::filesystem::path& file, const Picture& picture) {
  // Opaque RGB: an alpha channel of 255 says nothing.
  std::vector<std::uint8_t> rgb;
  rgb.reserve(std::size_t{3} * picture.width * picture.height);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    rgb.insert(rgb.end(), {picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]});
  }
  write_atomically(file, [&](const std::filesystem::path& name) {
    const int width = static_cast<int>(picture.width);
    const int height = static_cast<int>(picture.height);
    if (stbi_write_png(name.c_str(), width, height, 3, rgb.data(), 3 * width) == 0) {
      throw std::runtime_error("the folder does not exist or is not writable");
    }
  });
}

void write_pfm(const std::filesystem::path& file, const Picture& picture) {
  write_atomically(file, [&](const std::filesystem::path& name) {
    std::ofstream out(name, std::ios::binary);
    out << "PF\n" << picture.width << ' ' << picture.height << "\n-1.0\n";
    const std::size_t row = std::size_t{3} * picture.width;
    for (std::uint32_t y = picture.height; y-- > 0;) {  // rows go from the bottom up
      out.write(reinterpret_cast<const char*>(&picture.rgb[y * row]),
                static_cast<std::streamsize>(row * sizeof(float)));
    }
    out.close();
    if (!out) {
      throw std::runtime_error("the folder does not exist or is full");
    }
  });
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_atomically(file, [&](const std::filesystem::path& name) {
    std::ofstream out(name, std::ios::binary);
    out << text;
    out.close();
    if (!out) {
      throw std::runtime_error("the folder does not exist or is full");
    }
  });
}

}  // namespace a2rt::render
