// Pictures and statistics on disk; nothing half-written is left behind.
#pragma once

#include <filesystem>
#include <functional>

#include "render/renderer.h"

namespace a2rt::render {

// Calls `write` with a temporary name beside `file`, then renames it. Throws UserError and removes
// the temporary file if `write` throws.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

void write_png(const std::filesystem::path& file, const Picture& picture);
// Portable float map: linear RGB, little-endian.
void write_pfm(const std::filesystem::path& file, const Picture& picture);
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace a2rt::render
