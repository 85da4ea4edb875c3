// Little-endian packing of records, byte by byte, independent of the host.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "a2rt/base/error.h"
#include "a2rt/base/vec.h"

namespace a2rt::bvh {

class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}
  void u8(std::uint32_t v) { out_.push_back(static_cast<std::byte>(v & 0xffU)); }
  void u16(std::uint32_t v) {
    u8(v);
    u8(v >> 8);
  }
  void u32(std::uint32_t v) {
    u16(v);
    u16(v >> 16);
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
  // `bits` low bits of v, least significant first; bit fields end with align().
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
  void pad_to(std::size_t size) {
    A2RT_CHECK(out_.size() <= size, "a record is longer than its slot");
    out_.resize(size);
  }
  std::size_t size() const { return out_.size(); }

 private:
  std::vector<std::byte>& out_;
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
