// The record buffer: an unbounded append-only memory for the shaders, a bounded one for the host.
//
// Shaders append to a large reserved range of addresses (lavapipe's device addresses are host
// addresses). A thread follows their cursor and moves what lies behind it to the file. A shader
// may still be about to store into a place it has reserved long ago, so a plain copy could lose
// records. Therefore:
//   1. a chunk is taken away as a whole by remapping its pages (MREMAP_DONTUNMAP): stores before
//      that moment are in the pages taken, stores after it go to fresh zero pages at the old place;
//   2. when no shader runs (quiesce), the fresh pages behind the cursor are found and OR-ed into
//      the file. Each word of the buffer is stored once and begins as zero, hence OR is exact.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "a2rt/capture/records.h"

namespace a2rt::layer {

class RecordStream {
 public:
  // Creates the file and fills `header.records`, `header.capacity`. `limit_bytes` bounds the file
  // (0: what disk and format allow), `memory_bytes` the records that wait for the disk between two
  // dispatches. Throws std::runtime_error with a remedy.
  RecordStream(std::string path, std::uint64_t limit_bytes, std::uint64_t memory_bytes,
               capture::RecordHeader& header);
  ~RecordStream();
  RecordStream(const RecordStream&) = delete;
  RecordStream& operator=(const RecordStream&) = delete;

  // Call only while no shader writes. Afterwards everything drained so far is exact in the file.
  void quiesce();
  // Call only while no shader writes: drains the rest and cuts the file to its size. Returns the
  // number of units, or throws std::runtime_error if they could not be written.
  std::uint64_t finish();

  std::uint64_t used_units() const;
  // Pages that shaders stored into after their chunk had been taken; for the log and the tests.
  std::uint64_t late_pages() const { return late_pages_; }

 private:
  void open_file();
  void reserve(std::uint64_t bytes);
  void run();
  void drain_until(std::uint64_t end);
  void drain_chunks(std::uint64_t bytes);
  void merge_late_pages();
  void merge_page(std::byte* page, std::uint64_t offset);
  void write_at(const std::byte* data, std::size_t bytes, std::uint64_t offset);
  std::uint64_t used_bytes() const;

  std::string path_;
  capture::RecordHeader& header_;
  std::uint64_t memory_bytes_;
  int file_ = -1;
  std::byte* base_ = nullptr;     // first unit, chunk-aligned
  std::byte* staging_ = nullptr;  // where taken chunks stand while they are written
  std::byte* reservation_ = nullptr;
  std::size_t reservation_bytes_ = 0;

  std::mutex mutex_;           // guards the members below and the file
  std::uint64_t drained_ = 0;  // bytes in the file
  std::uint64_t merged_ = 0;   // bytes whose late stores are in the file
  std::uint64_t late_pages_ = 0;
  bool takes_while_running_ = true;  // kernel has MREMAP_DONTUNMAP
  std::string error_;
  bool stop_ = false;
  std::condition_variable wake_;
  std::thread thread_;
};

}  // namespace a2rt::layer
