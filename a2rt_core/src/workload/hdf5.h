// HDF5's C interface with owned handles and errors as exceptions.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace a2rt::h5 {

// Owns one HDF5 identifier.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle(hid_t id, Closer close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) {
      close_(id_);
    }
  }
  hid_t id() const { return id_; }
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  Closer close_;
};

// Keeps HDF5 from printing its error stack while in scope.
class Quiet {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

// The innermost reason on HDF5's error stack.
std::string last_error();

// A member of a compound: name, place in memory, HDF5 type.
struct Member {
  const char* name;
  std::size_t offset;
  hid_t type;
};
Handle compound(std::size_t bytes, const std::vector<Member>& members);
Handle array_type(hid_t element, const std::vector<hsize_t>& dims);

// An open file or group; `place` names it in messages ("file.h5: /rays").
class Location {
 public:
  Location(Handle handle, std::string place)
      : handle_(std::move(handle)), place_(std::move(place)) {}
  hid_t id() const { return handle_.id(); }
  const std::string& place() const { return place_; }

  Location create_group(const std::string& name) const;
  Location open_group(const std::string& name) const;
  bool has(const std::string& name) const;
  bool has_attribute(const std::string& name) const;

  void write_attribute(const std::string& name, const std::string& text) const;
  void write_attribute(const std::string& name, std::uint32_t value) const;
  std::string text_attribute(const std::string& name) const;
  std::uint32_t integer_attribute(const std::string& name) const;

  // Rows of `row_bytes` bytes each, type `type`. deflate = 0: contiguous.
  void write_rows(const std::string& name, hid_t type, const void* data, std::uint64_t rows,
                  std::size_t row_bytes, int deflate) const;
  // Number of rows of a one-dimensional dataset whose type holds every member of `type`.
  std::uint64_t rows(const std::string& name, hid_t type) const;
  void read_rows(const std::string& name, hid_t type, void* data, std::uint64_t expected) const;

  [[noreturn]] void fail(const std::string& object, const std::string& what) const;

 private:
  Handle dataset(const std::string& name) const;
  Handle handle_;
  std::string place_;
};

Location create_file(const std::string& path, std::uint64_t user_block_bytes);
Location open_file(const std::string& path);

}  // namespace a2rt::h5
