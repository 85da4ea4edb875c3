#include "verdicts/verdict_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace a2rt::layer {
namespace {

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
    if (!file_) {
      throw std::runtime_error("cannot open verdict file " + path + ": " + std::strerror(errno));
    }
    file_.seekg(0, std::ios::end);
    left_ = static_cast<std::uint64_t>(file_.tellg());
    file_.seekg(0);
  }

  template <class T>
  T value() {
    T out{};
    read(&out, sizeof(T));
    return out;
  }

  template <class T>
  std::vector<T> array(std::uint32_t count) {
    // Checked before the memory is asked for, so that a damaged count cannot exhaust it.
    if (std::uint64_t{count} * sizeof(T) > left_) {
      fail("is cut off");
    }
    std::vector<T> out(count);
    read(out.data(), out.size() * sizeof(T));
    return out;
  }

  std::uint64_t left() const { return left_; }

  [[noreturn]] void fail(const std::string& what) {
    throw std::runtime_error("verdict file " + path_ + " " + what + " (byte " +
                             std::to_string(offset_) + "); write it again with a2rt-core");
  }

 private:
  void read(void* target, std::size_t bytes) {
    if (bytes > left_) {
      fail("is cut off");
    }
    file_.read(static_cast<char*>(target), static_cast<std::streamsize>(bytes));
    if (!file_) {
      fail("cannot be read");
    }
    left_ -= bytes;
    offset_ += bytes;
  }

  std::string path_;
  std::ifstream file_;
  std::uint64_t left_ = 0;
  std::uint64_t offset_ = 0;
};

DispatchVerdicts read_dispatch(Reader& reader, const capture::VerdictDispatchHeader& header) {
  DispatchVerdicts out;
  out.index = reader.array<LaunchVerdicts>(header.launches);
  out.entries = reader.array<capture::VerdictEntry>(header.entries);
  for (const LaunchVerdicts& launch : out.index) {
    if (std::uint64_t{launch.first} + launch.count > header.entries) {
      reader.fail("refers to entries that it does not have");
    }
  }
  return out;
}

}  // namespace

VerdictFile::VerdictFile(const std::string& path) {
  Reader reader(path);
  const auto header = reader.value<capture::VerdictFileHeader>();
  if (header.magic != capture::kVerdictMagic) {
    reader.fail("does not begin with the mark of a verdict file");
  }
  if (header.version != capture::kFormatVersion) {
    reader.fail("has version " + std::to_string(header.version) + ", this layer reads version " +
                std::to_string(capture::kFormatVersion));
  }
  for (std::uint32_t i = 0; i < header.dispatches; ++i) {
    const auto dispatch = reader.value<capture::VerdictDispatchHeader>();
    if (!tables_.emplace(dispatch.dispatch, read_dispatch(reader, dispatch)).second) {
      reader.fail("has dispatch " + std::to_string(dispatch.dispatch) + " twice");
    }
  }
  if (reader.left() != 0) {
    reader.fail("has bytes after its last dispatch");
  }
}

const DispatchVerdicts* VerdictFile::find(std::uint32_t dispatch) const {
  const auto found = tables_.find(dispatch);
  return found == tables_.end() ? nullptr : &found->second;
}

}  // namespace a2rt::layer
