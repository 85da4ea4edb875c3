// What one device captures: the header page, the record stream and the manifest, under one
// directory, complete or not there at all.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "a2rt/capture/manifest.h"
#include "a2rt/capture/records.h"
#include "capture/manifest_writer.h"
#include "capture/record_stream.h"
#include "layer/settings.h"
#include "spirv/instrument.h"
#include "verdicts/verdict_file.h"

namespace a2rt::layer {

// The page that instrumented shaders read. It stands at a fixed address because that address is
// in the SPIR-V: a new one in every run would make the driver compile every shader anew.
class HeaderPage {
 public:
  HeaderPage();
  ~HeaderPage();
  HeaderPage(const HeaderPage&) = delete;
  HeaderPage& operator=(const HeaderPage&) = delete;
  capture::RecordHeader& operator*() const { return *header_; }
  capture::RecordHeader* operator->() const { return header_; }
  std::uint64_t address() const { return reinterpret_cast<std::uint64_t>(header_); }

 private:
  capture::RecordHeader* header_ = nullptr;
};

// One ordinal per launch id of the largest dispatch so far.
class OrdinalTable {
 public:
  ~OrdinalTable();
  // Call only while no shader runs. `zero` clears the part in use.
  void prepare(capture::RecordHeader& header, std::uint64_t launches, bool zero);

 private:
  void release();
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
  std::uint64_t launches_ = 0;
};

class Session {
 public:
  // Opens what the settings ask for. Throws std::runtime_error with a remedy.
  explicit Session(const Settings& settings);
  ~Session();

  bool capturing() const { return manifest_ != nullptr; }
  // Null without capture.
  ManifestWriter* manifest() { return manifest_.get(); }
  spirv::InstrumentOptions instrument_options(std::uint32_t first_shader_index) const;

  // The functions below are called only while no shader runs.

  // Makes the header ready for the next dispatch. `block` comes without dispatch and first_unit.
  // Returns the index of the dispatch.
  std::uint32_t begin_dispatch(capture::DispatchBlock block,
                               const std::vector<capture::SiteBinding>& bindings);
  void quiesce();
  // Writes kEnd and gives the files their names. If nothing was traced or something failed, the
  // files are removed and a line says so. Idempotent.
  void finish();
  // Whether finish() gave the files their names.
  bool complete() const { return complete_; }
  // Closes and removes the files; `why` is logged.
  void abandon(const std::string& why);

 private:
  void use_verdicts(std::uint32_t dispatch);
  std::string part(const char* name) const;
  std::string final_name(const char* name) const;

  Settings settings_;
  HeaderPage header_;
  OrdinalTable ordinals_;
  std::vector<std::byte> spare_;  // where records go that nobody asked for
  std::unique_ptr<RecordStream> records_;
  std::unique_ptr<ManifestWriter> manifest_;
  std::optional<VerdictFile> verdicts_;
  std::uint32_t dispatches_ = 0;
  bool finished_ = false;
  bool complete_ = false;
};

}  // namespace a2rt::layer
