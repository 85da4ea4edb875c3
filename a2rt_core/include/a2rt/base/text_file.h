// Whole text files, never left half written.
#pragma once

#include <filesystem>
#include <string_view>

namespace a2rt {

// Writes to a temporary name beside `file` and renames it. Throws UserError naming the file if the
// disk refuses; nothing is left behind then.
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace a2rt
