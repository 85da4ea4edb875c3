// Writes the blocks of manifest.bin. The only writer of that file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <mutex>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "a2rt/capture/manifest.h"

namespace a2rt::layer {

using Bytes = std::span<const std::byte>;

// The bytes of one value or of a contiguous array; nothing is copied.
template <class T>
  requires std::is_trivially_copyable_v<T>
Bytes bytes_of(const T& value) {
  return std::as_bytes(std::span<const T, 1>(&value, 1));
}
template <class T>
Bytes bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span<const T>(values));
}

// Payload of a string: {u32 length, bytes}.
std::vector<std::byte> encode_string(const std::string& text);

class ManifestWriter {
 public:
  // Creates the file; throws std::runtime_error if that fails.
  explicit ManifestWriter(std::string path);
  ~ManifestWriter();
  ManifestWriter(const ManifestWriter&) = delete;
  ManifestWriter& operator=(const ManifestWriter&) = delete;

  // Writes one block whose payload is `parts` end to end. Thread-safe. The first failure is logged
  // and remembered; later blocks are dropped.
  void write(capture::BlockType type, std::initializer_list<Bytes> parts);
  void write(capture::BlockType type, std::span<const Bytes> parts);
  void refuse(const std::string& what);

  bool failed() const;
  void close();

 private:
  void write_all(Bytes bytes);

  mutable std::mutex mutex_;
  std::string path_;
  int file_ = -1;
  bool failed_ = false;
};

}  // namespace a2rt::layer
