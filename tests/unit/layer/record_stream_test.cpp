#include "capture/record_stream.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

namespace a2rt::layer {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

struct Stream {
  Stream()
      : path(std::filesystem::temp_directory_path() /
             ("a2rt-stream-" + std::to_string(::getpid()))) {}
  ~Stream() { std::filesystem::remove(path); }
  std::uint64_t* words() const { return reinterpret_cast<std::uint64_t*>(header.records); }
  // As a shader reserves units.
  std::uint64_t reserve(std::uint32_t units) {
    return std::atomic_ref(header.cursor).fetch_add(units);
  }
  std::filesystem::path path;
  alignas(64) capture::RecordHeader header{};
};

std::uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t size = 0;
  std::uint64_t resident = 0;
  file >> size >> resident;
  return resident * 4096;
}

// The value that belongs at a word; never zero.
std::uint64_t mark(std::uint64_t word) { return word * 0x9e3779b97f4a7c15u | 1u; }

void expect_file(const std::filesystem::path& path, std::uint64_t units) {
  ASSERT_EQ(std::filesystem::file_size(path), units * capture::kUnitBytes);
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint64_t> block(1 << 17);
  std::uint64_t word = 0;
  while (word < units * 2) {
    const auto count = std::min<std::uint64_t>(block.size(), units * 2 - word);
    file.read(reinterpret_cast<char*>(block.data()), static_cast<std::streamsize>(count * 8));
    for (std::uint64_t i = 0; i < count; ++i, ++word) {
      ASSERT_EQ(block[i], mark(word)) << "word " << word;
    }
  }
}

TEST(RecordStream, keeps_memory_bounded_while_one_dispatch_writes_on) {
  Stream stream;
  RecordStream records(stream.path.string(), 2048 * kMiB, 64 * kMiB, stream.header);
  const std::uint64_t before = resident_bytes();
  std::uint64_t most = 0;
  constexpr std::uint64_t kUnits = 384 * kMiB / capture::kUnitBytes;
  constexpr std::uint32_t kStep = 4096;
  for (std::uint64_t done = 0; done < kUnits; done += kStep) {
    const std::uint64_t unit = stream.reserve(kStep);
    for (std::uint64_t word = unit * 2; word < (unit + kStep) * 2; ++word) {
      stream.words()[word] = mark(word);
    }
    if (done % (256 * kStep) == 0) {
      // Shaders make about 400 MB/s; the machine may be busy.
      std::this_thread::sleep_for(std::chrono::milliseconds(40));
      most = std::max(most, resident_bytes());
    }
  }
  EXPECT_LT(most - before, 256 * kMiB);
  EXPECT_EQ(records.finish(), kUnits);
  expect_file(stream.path, kUnits);
}

TEST(RecordStream, stores_that_come_after_their_chunk_was_taken_are_not_lost) {
  Stream stream;
  RecordStream records(stream.path.string(), 1024 * kMiB, 64 * kMiB, stream.header);
  constexpr std::uint64_t kUnits = 96 * kMiB / capture::kUnitBytes;
  stream.reserve(kUnits);
  const auto is_late = [](std::uint64_t word) { return word % 1001 < 3 && word < 4000000; };
  for (std::uint64_t word = 0; word < kUnits * 2; ++word) {
    if (!is_late(word)) {
      stream.words()[word] = mark(word);
    }
  }
  // Give the stream time to take the chunks away under the slow writer.
  while (std::filesystem::file_size(stream.path) < 64 * kMiB) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  for (std::uint64_t word = 0; word < kUnits * 2; ++word) {
    if (is_late(word)) {
      stream.words()[word] = mark(word);
    }
  }
  records.quiesce();
  EXPECT_EQ(records.finish(), kUnits);
  EXPECT_GT(records.late_pages(), 0u);
  expect_file(stream.path, kUnits);
}

TEST(RecordStream, a_limit_beyond_the_disk_is_cut_and_a_missing_folder_is_an_error) {
  Stream stream;
  {
    const RecordStream records(stream.path.string(), 0, 64 * kMiB, stream.header);
    EXPECT_LE(std::uint64_t{stream.header.capacity} * capture::kUnitBytes, std::uint64_t{64} << 30);
    EXPECT_GT(stream.header.capacity, 0u);
  }
  EXPECT_THROW(RecordStream("/nonexistent/records", 0, kMiB, stream.header), std::runtime_error);
}

}  // namespace
}  // namespace a2rt::layer
