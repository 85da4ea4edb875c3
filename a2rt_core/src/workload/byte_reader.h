// A cursor over untrusted bytes: every read is checked and says where it failed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include "a2rt/base/error.h"

namespace a2rt {

class ByteReader {
 public:
  // `base` is the place of the first byte in the file called `name`.
  ByteReader(std::span<const std::byte> bytes, std::string name, std::uint64_t base = 0)
      : bytes_(bytes), name_(std::move(name)), base_(base) {}

  std::uint64_t place() const { return base_ + at_; }
  std::size_t left() const { return bytes_.size() - at_; }

  template <class T>
  T get(const char* what) {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, take(sizeof(T), what).data(), sizeof(T));
    return value;
  }
  std::span<const std::byte> take(std::uint64_t bytes, const char* what) {
    if (bytes > left()) {
      fail(std::string("cut off: ") + what + " needs " + std::to_string(bytes) + " bytes, " +
           std::to_string(left()) + " are left");
    }
    const auto part = bytes_.subspan(at_, bytes);
    at_ += bytes;
    return part;
  }
  // `count` rows of T; checks the room before anything is allocated.
  template <class Rows>
  void get_rows(Rows& rows, std::uint64_t count, const char* what) {
    using T = typename Rows::value_type;
    if (count > left() / sizeof(T)) {
      fail(std::string("cut off: ") + std::to_string(count) + " " + what + " do not fit in " +
           std::to_string(left()) + " bytes");
    }
    const auto part = take(count * sizeof(T), what);
    rows.resize(count);
    if (count > 0) {
      std::memcpy(static_cast<void*>(rows.data()), part.data(), part.size());
    }
  }
  std::string get_text(const char* what) {
    const auto length = get<std::uint32_t>(what);
    const auto part = take(length, what);
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }
  // A reader of the next `bytes` bytes, which are skipped here.
  ByteReader sub(std::uint64_t bytes, const char* what) {
    const std::uint64_t start = place();
    return {take(bytes, what), name_, start};
  }
  [[noreturn]] void fail(const std::string& problem) const {
    throw UserError(name_ + ": byte " + std::to_string(place()) + ": " + problem);
  }

 private:
  std::span<const std::byte> bytes_;
  std::string name_;
  std::uint64_t base_;
  std::size_t at_ = 0;
};

}  // namespace a2rt
