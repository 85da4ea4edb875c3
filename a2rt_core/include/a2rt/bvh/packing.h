// Little-endian packing of records, byte by byte, independent of the host.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/vec.h"

namespace a2rt::bvh {

// Writes from the front of a vector, which grows as needed and is cut to size by finish().
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out, std::size_t expected = 0) : out_(out) {
    out_.resize(expected);
  }

  void u8(std::uint32_t v) { *claim(1) = static_cast<std::byte>(v & 0xffU); }
  void u16(std::uint32_t v) {
    u8(v);
    u8(v >> 8);
  }
  void u32(std::uint32_t v) {
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(claim(4), &v, 4);
    } else {
      u16(v);
      u16(v >> 16);
    }
  }
  void f32(float v) { u32(std::bit_cast<std::uint32_t>(v)); }
  void vec3(const Vec3& v) {
    f32(v.x);
    f32(v.y);
    f32(v.z);
  }
  void box(const Box& b) {
    vec3(b.lo);
    vec3(b.hi);
  }
  void raw(std::span<const std::byte> bytes) {
    std::copy(bytes.begin(), bytes.end(), claim(bytes.size()));
  }
  // `count` low bits of v, least significant first; bit fields end with align().
  void bits(std::uint32_t v, int count) {
    for (int i = 0; i < count; ++i) {
      pending_ |= ((v >> i) & 1U) << pending_bits_;
      if (++pending_bits_ == 8) {
        align();
      }
    }
  }
  void align() {
    if (pending_bits_ > 0) {
      u8(pending_);
      pending_ = 0;
      pending_bits_ = 0;
    }
  }
  // Zeros up to byte `size`.
  void pad_to(std::size_t size) {
    A2RT_CHECK(at_ <= size, "a record is longer than its slot");
    const std::size_t n = size - at_;
    std::fill_n(claim(n), n, std::byte{0});
  }
  std::size_t size() const { return at_; }
  // Cuts the vector to what was written; call it last.
  void finish() { out_.resize(at_); }

 private:
  // Room for n more bytes.
  std::byte* claim(std::size_t n) {
    start_ = at_;
    at_ += n;
    if (at_ > out_.size()) {
      out_.resize(std::max(at_, 2 * out_.size()));
    }
    return out_.data() + start_;
  }

  std::vector<std::byte>& out_;
  std::size_t at_ = 0, start_ = 0;
  std::uint32_t pending_ = 0;
  int pending_bits_ = 0;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> in, std::size_t at = 0) : in_(in), at_(at) {}
  std::uint32_t u8() {
    A2RT_CHECK(at_ < in_.size(), "read past the end of the records");
    return static_cast<std::uint32_t>(in_[at_++]);
  }
  std::uint32_t u16() {
    const std::uint32_t low = u8();
    return low | u8() << 8;
  }
  std::uint32_t u32() {
    const std::uint32_t low = u16();
    return low | u16() << 16;
  }
  float f32() { return std::bit_cast<float>(u32()); }
  Vec3 vec3() {
    const float x = f32(), y = f32(), z = f32();
    return {x, y, z};
  }
  Box box() {
    const Vec3 lo = vec3(), hi = vec3();
    return {lo, hi};
  }
  std::uint32_t bits(int count) {
    std::uint32_t v = 0;
    for (int i = 0; i < count; ++i) {
      if (left_ == 0) {
        current_ = u8();
        left_ = 8;
      }
      v |= (current_ & 1U) << i;
      current_ >>= 1;
      --left_;
    }
    return v;
  }
  void align() { left_ = 0; }
  std::size_t at() const { return at_; }

 private:
  std::span<const std::byte> in_;
  std::size_t at_;
  std::uint32_t current_ = 0;
  int left_ = 0;
};

}  // namespace a2rt::bvh
