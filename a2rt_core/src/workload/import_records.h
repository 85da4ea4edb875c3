// records.bin: finding the records, and bringing them into the order of launch ids.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "a2rt/capture/records.h"
#include "import_manifest.h"

namespace a2rt::import {

// One record where it lies in the file.
class Record {
 public:
  explicit Record(const std::byte* at) : at_(at) {}

  capture::RecordKind kind() const { return static_cast<capture::RecordKind>(word(0, 0) & 0xff); }
  capture::Stage stage() const { return static_cast<capture::Stage>((word(0, 0) >> 8) & 0xff); }
  std::uint32_t shader() const { return word(0, 0) >> 16; }
  std::uint32_t launch() const { return word(0, 1); }
  std::uint32_t dispatch() const { return word(0, 2); }
  std::uint32_t ordinal() const { return word(0, 3); }

  std::uint32_t word(std::size_t unit, std::size_t index) const {
    return read<std::uint32_t>(unit, index);
  }
  float number(std::size_t unit, std::size_t index) const { return read<float>(unit, index); }
  std::array<std::uint32_t, 8> counters(std::size_t first_unit) const {
    std::array<std::uint32_t, 8> counts;
    std::memcpy(counts.data(), at_ + first_unit * capture::kUnitBytes, sizeof counts);
    return counts;
  }

 private:
  template <class T>
  T read(std::size_t unit, std::size_t index) const {
    T value;
    std::memcpy(&value, at_ + unit * capture::kUnitBytes + index * sizeof value, sizeof value);
    return value;
  }
  const std::byte* at_;
};

// Units of a record of this kind, or 0 if there is no such kind.
std::uint32_t units_of(capture::RecordKind kind);

// The records of one dispatch, by launch id and in program order within one.
class DispatchRecords {
 public:
  // Scans units [first, last) of `records`. Throws UserError naming the byte of a damaged record.
  DispatchRecords(std::span<const std::byte> records, std::uint64_t first, std::uint64_t last,
                  const RawDispatch& dispatch);

  std::size_t size() const { return order_.size(); }
  Record operator[](std::size_t i) const {
    return Record(base_ + (order_[i] & 0xffffffffu) * capture::kUnitBytes);
  }
  const std::array<std::uint64_t, 10>& counts() const { return counts_; }

 private:
  const std::byte* base_;
  // launch << 32 | unit: sorting these keeps the file's order within a launch id.
  std::vector<std::uint64_t> order_;
  std::array<std::uint64_t, 10> counts_{};
};

}  // namespace a2rt::import
