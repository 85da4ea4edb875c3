#include "capture/record_stream.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "layer/log.h"

#ifndef MREMAP_DONTUNMAP
#define MREMAP_DONTUNMAP 4
#endif

namespace a2rt::layer {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
constexpr std::uint64_t kChunk = 2 * kMiB;   // a huge page: one page-table move, one fault
constexpr std::uint64_t kBatch = 16 * kMiB;  // taken and written at once
constexpr std::uint64_t kSlack = 8 * kMiB;   // left behind the cursor to have few late stores
constexpr std::uint64_t kDiskReserve = 256 * kMiB;
constexpr std::size_t kPage = 4096;
// The shaders' cursor is a u32 that may pass the capacity by one record per running invocation.
constexpr std::uint64_t kMostUnits = 0xfff00000u;
// Between looks at the cursor: the longer it stands still, the longer.
constexpr auto kShortestPoll = std::chrono::milliseconds(2);
constexpr auto kLongestPoll = std::chrono::milliseconds(16);

std::uint64_t align_up(std::uint64_t value, std::uint64_t step) {
  return (value + step - 1) / step * step;
}

std::string reason() { return std::strerror(errno); }

std::uint64_t free_disk_bytes(const std::string& path) {
  struct statvfs info {};
  const std::string folder = std::filesystem::path(path).parent_path().string();
  if (::statvfs(folder.empty() ? "." : folder.c_str(), &info) != 0) {
    throw std::runtime_error("cannot ask for the free space at " + path + ": " + reason());
  }
  return static_cast<std::uint64_t>(info.f_bavail) * info.f_frsize;
}

std::uint64_t choose_limit(const std::string& path, std::uint64_t wanted) {
  const std::uint64_t available = free_disk_bytes(path);
  if (available < kDiskReserve + 64 * kMiB) {
    throw std::runtime_error("only " + std::to_string(available / kMiB) + " MiB are free at " +
                             path + "; free at least 320 MiB there or capture to another disk");
  }
  std::uint64_t limit = std::min(kMostUnits * capture::kUnitBytes, available - kDiskReserve);
  if (wanted != 0) {
    limit = std::min(limit, wanted);
  }
  return limit / capture::kUnitBytes * capture::kUnitBytes;
}

}  // namespace

RecordStream::RecordStream(std::string path, std::uint64_t limit_bytes, std::uint64_t memory_bytes,
                           capture::RecordHeader& header)
    : path_(std::move(path)), header_(header), memory_bytes_(memory_bytes) {
  open_file();
  const std::uint64_t limit = choose_limit(path_, limit_bytes);
  reserve(limit);
  header_.records = reinterpret_cast<std::uint64_t>(base_);
  header_.capacity = static_cast<std::uint32_t>(limit / capture::kUnitBytes);
  thread_ = std::thread([this] { run(); });
}

RecordStream::~RecordStream() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }
  if (reservation_ != nullptr) {
    ::munmap(reservation_, reservation_bytes_);
  }
  if (file_ >= 0) {
    ::close(file_);
  }
}

void RecordStream::open_file() {
  // Direct writes take the pages as they are: no copy, and no page cache that grows with the
  // capture. File systems without them get ordinary writes.
  constexpr int kFlags = O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC;
  file_ = ::open(path_.c_str(), kFlags | O_DIRECT, 0644);
  if (file_ < 0) {
    file_ = ::open(path_.c_str(), kFlags, 0644);
  }
  if (file_ < 0) {
    throw std::runtime_error("cannot create " + path_ + ": " + reason());
  }
}

void RecordStream::reserve(std::uint64_t bytes) {
  const std::uint64_t window =
      align_up(bytes + std::uint64_t{capture::kSpareUnits} * capture::kUnitBytes, kChunk);
  reservation_bytes_ = window + kBatch + 2 * kChunk;
  void* memory = ::mmap(nullptr, reservation_bytes_, PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) {
    throw std::runtime_error("cannot reserve " + std::to_string(reservation_bytes_ / kMiB) +
                             " MiB of addresses for records: " + reason() +
                             "; set A2RT_LIMIT to a smaller size, e.g. 2G");
  }
  reservation_ = static_cast<std::byte*>(memory);
  const auto start = align_up(reinterpret_cast<std::uint64_t>(memory), kChunk);
  base_ = reinterpret_cast<std::byte*>(start);
  staging_ = base_ + window;
  // Without huge pages it is only slower.
  ::madvise(base_, window, MADV_HUGEPAGE);
}

std::uint64_t RecordStream::used_units() const {
  const std::uint32_t cursor = std::atomic_ref(header_.cursor).load(std::memory_order_acquire);
  return std::min(cursor, header_.capacity);
}

std::uint64_t RecordStream::used_bytes() const { return used_units() * capture::kUnitBytes; }

void RecordStream::run() {
  std::unique_lock lock(mutex_);
  auto interval = kShortestPoll;
  std::uint64_t seen = 0;
  while (!stop_) {
    wake_.wait_for(lock, interval);
    const std::uint64_t used = used_bytes();
    interval = used != seen ? kShortestPoll : std::min(2 * interval, kLongestPoll);
    seen = used;
    if (takes_while_running_ && used > drained_ + kSlack + kBatch) {
      drain_until((used - kSlack) / kChunk * kChunk);
    }
  }
}

// Moves whole chunks to the file up to byte `end`, a multiple of the chunk.
void RecordStream::drain_until(std::uint64_t end) {
  while (drained_ < end && error_.empty()) {
    drain_chunks(std::min(kBatch, end - drained_));
    if (!takes_while_running_) {
      return;
    }
  }
}

void RecordStream::drain_chunks(std::uint64_t bytes) {
  std::byte* from = base_ + drained_;
  void* moved =
      ::mremap(from, bytes, bytes, MREMAP_MAYMOVE | MREMAP_FIXED | MREMAP_DONTUNMAP, staging_);
  if (moved == MAP_FAILED) {
    info("the kernel cannot take pages from running shaders (" + reason() +
         "); records wait in memory until a dispatch has ended");
    takes_while_running_ = false;
    return;
  }
  write_at(staging_, bytes, drained_);
  ::madvise(staging_, bytes, MADV_DONTNEED);
  drained_ += bytes;
}

void RecordStream::write_at(const std::byte* data, std::size_t bytes, std::uint64_t offset) {
  while (bytes > 0 && error_.empty()) {
    const ssize_t written = ::pwrite(file_, data, bytes, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written < 0 && errno == EINVAL && (::fcntl(file_, F_GETFL) & O_DIRECT) != 0) {
      ::fcntl(file_, F_SETFL, ::fcntl(file_, F_GETFL) & ~O_DIRECT);
      continue;
    }
    if (written <= 0) {
      error_ = "cannot write " + path_ + " after " + std::to_string(offset / kMiB) +
               " MiB: " + reason() +
               "; free space there, capture to another disk, or bound the capture with A2RT_LIMIT";
      warn(error_);
      // From here on records are counted as lost instead of filling the memory.
      std::atomic_ref(header_.capacity).store(0);
      return;
    }
    data += written;
    offset += static_cast<std::uint64_t>(written);
    bytes -= static_cast<std::size_t>(written);
  }
}

void RecordStream::quiesce() {
  const std::lock_guard lock(mutex_);
  merge_late_pages();
  const std::uint64_t used = used_bytes();
  if (used > drained_ && used - drained_ > memory_bytes_) {
    const std::uint64_t end = used / kChunk * kChunk;
    if (takes_while_running_) {
      drain_until(end);
    }
    if (!takes_while_running_ && error_.empty() && end > drained_) {
      write_at(base_ + drained_, end - drained_, drained_);
      ::madvise(base_ + drained_, end - drained_, MADV_DONTNEED);
      drained_ = end;
    }
    merged_ = drained_;
  }
}

void RecordStream::merge_late_pages() {
  if (merged_ >= drained_) {
    return;
  }
  const int map = ::open("/proc/self/pagemap", O_RDONLY | O_CLOEXEC);
  const std::uint64_t first = reinterpret_cast<std::uint64_t>(base_ + merged_) / kPage;
  std::vector<std::uint64_t> entries((drained_ - merged_) / kPage);
  const std::size_t bytes = entries.size() * sizeof(entries[0]);
  const bool known = map >= 0 && ::pread(map, entries.data(), bytes,
                                         static_cast<off_t>(first * sizeof(entries[0]))) ==
                                     static_cast<ssize_t>(bytes);
  if (map >= 0) {
    ::close(map);
  }
  constexpr std::uint64_t kPresentOrSwapped = std::uint64_t{3} << 62;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!known || (entries[i] & kPresentOrSwapped) != 0) {
      merge_page(base_ + merged_ + i * kPage, merged_ + i * kPage);
    }
  }
  ::madvise(base_ + merged_, drained_ - merged_, MADV_DONTNEED);
  merged_ = drained_;
}

void RecordStream::merge_page(std::byte* page, std::uint64_t offset) {
  alignas(kPage) static thread_local std::array<std::uint64_t, kPage / 8> in_file;
  std::array<std::uint64_t, kPage / 8> late;
  std::memcpy(late.data(), page, kPage);
  if (std::all_of(late.begin(), late.end(), [](std::uint64_t word) { return word == 0; })) {
    return;
  }
  if (::pread(file_, in_file.data(), kPage, static_cast<off_t>(offset)) != ssize_t{kPage}) {
    error_ = "cannot read back " + path_ + ": " + reason();
    return;
  }
  for (std::size_t i = 0; i < late.size(); ++i) {
    in_file[i] |= late[i];
  }
  write_at(reinterpret_cast<const std::byte*>(in_file.data()), kPage, offset);
  ++late_pages_;
}

std::uint64_t RecordStream::finish() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
  const std::lock_guard lock(mutex_);
  merge_late_pages();
  const std::uint64_t used = used_bytes();
  if (error_.empty() && used > drained_) {
    // Direct writes need whole pages; the file is cut to its size below.
    write_at(base_ + drained_, align_up(used - drained_, kPage), drained_);
  }
  if (error_.empty() && ::ftruncate(file_, static_cast<off_t>(used)) != 0) {
    error_ = "cannot cut " + path_ + " to its size: " + reason();
  }
  if (!error_.empty()) {
    throw std::runtime_error(error_);
  }
  debug("records: " + std::to_string(used) + " bytes, " + std::to_string(late_pages_) +
        " pages completed after they had been written");
  return used / capture::kUnitBytes;
}

}  // namespace a2rt::layer
