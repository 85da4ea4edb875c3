#include "temporary_file.h"

#include <unistd.h>

#include <string>
#include <system_error>

#include "a2rt/base/error.h"

namespace a2rt {

TemporaryFile::TemporaryFile(std::filesystem::path target)
    : target_(std::move(target)), path_(target_) {
  path_ += ".part-" + std::to_string(::getpid());
}

TemporaryFile::~TemporaryFile() {
  if (!committed_) {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
}

void TemporaryFile::commit() {
  std::error_code error;
  std::filesystem::rename(path_, target_, error);
  if (error) {
    throw UserError("cannot give '" + path_.string() + "' its name '" + target_.string() +
                    "': " + error.message());
  }
  committed_ = true;
}

}  // namespace a2rt
