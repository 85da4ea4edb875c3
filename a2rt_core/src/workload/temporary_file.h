// A file that appears under its name only when it is complete.
#pragma once

#include <filesystem>

namespace a2rt {

class TemporaryFile {
 public:
  // Names a file beside `target`; nothing is created yet.
  explicit TemporaryFile(std::filesystem::path target);
  // Removes the file unless it was committed.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Gives the file its final name. Throws UserError.
  void commit();

 private:
  std::filesystem::path target_, path_;
  bool committed_ = false;
};

}  // namespace a2rt
