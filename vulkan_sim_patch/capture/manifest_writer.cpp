#include "capture/manifest_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "a2rt/capture/records.h"
#include "layer/log.h"

namespace a2rt::layer {

std::vector<std::byte> encode_string(const std::string& text) {
  const auto length = static_cast<std::uint32_t>(text.size());
  std::vector<std::byte> out(sizeof(length) + text.size());
  std::memcpy(out.data(), &length, sizeof(length));
  std::memcpy(out.data() + sizeof(length), text.data(), text.size());
  return out;
}

ManifestWriter::ManifestWriter(std::string path) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file_ < 0) {
    throw std::runtime_error("cannot create " + path_ + ": " + std::strerror(errno));
  }
  write_all(bytes_of(capture::kManifestMagic));
  write_all(bytes_of(capture::kFormatVersion));
}

ManifestWriter::~ManifestWriter() { close(); }

void ManifestWriter::write(capture::BlockType type, std::initializer_list<Bytes> parts) {
  write(type, std::span<const Bytes>(parts.begin(), parts.size()));
}

void ManifestWriter::write(capture::BlockType type, std::span<const Bytes> parts) {
  capture::BlockHeader header{static_cast<std::uint32_t>(type), capture::kFormatVersion, 0};
  for (const Bytes part : parts) {
    header.bytes += part.size();
  }
  const std::lock_guard lock(mutex_);
  // Small blocks go out in one system call; the arrays of a large structure are not copied.
  std::vector<std::byte> buffer;
  const auto append = [&](Bytes bytes) { buffer.insert(buffer.end(), bytes.begin(), bytes.end()); };
  constexpr std::size_t kCopyBelow = 1 << 16;
  append(bytes_of(header));
  for (const Bytes part : parts) {
    if (part.size() < kCopyBelow && buffer.size() < kCopyBelow) {
      append(part);
      continue;
    }
    write_all(buffer);
    buffer.clear();
    write_all(part);
  }
  write_all(buffer);
}

void ManifestWriter::refuse(const std::string& what) {
  warn(what);
  write(capture::BlockType::kRefused, {encode_string(what)});
}

bool ManifestWriter::failed() const {
  const std::lock_guard lock(mutex_);
  return failed_;
}

void ManifestWriter::close() {
  const std::lock_guard lock(mutex_);
  if (file_ >= 0) {
    ::close(file_);
    file_ = -1;
  }
}

void ManifestWriter::write_all(Bytes bytes) {
  while (!bytes.empty() && !failed_ && file_ >= 0) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      failed_ = true;
      warn("cannot write " + path_ + ": " + std::strerror(errno) +
           "; free space there or set A2RT_CAPTURE to another disk; the capture is given up");
      return;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace a2rt::layer
