#include "a2rt/base/text_file.h"

#include <fstream>
#include <system_error>

#include "a2rt/base/error.h"

namespace a2rt {

void write_text_file(const std::filesystem::path& file, std::string_view text) {
  std::filesystem::path temporary = file;
  temporary += ".part";
  std::error_code error;
  {
    std::ofstream out(temporary, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.flush();
    if (!out) {
      out.close();
      std::filesystem::remove(temporary, error);
      throw UserError("cannot write " + file.string() +
                      "; does its folder exist, and is there space and permission?");
    }
  }
  std::filesystem::rename(temporary, file, error);
  if (error) {
    const std::string reason = error.message();
    std::filesystem::remove(temporary, error);
    throw UserError("cannot replace " + file.string() + ": " + reason);
  }
}

}  // namespace a2rt
