// A file's bytes, mapped read-only: pages are loaded when touched and can be dropped again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace a2rt {

class MappedFile {
 public:
  // Throws UserError if the file cannot be read.
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace a2rt
