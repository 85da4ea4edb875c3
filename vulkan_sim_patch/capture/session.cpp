#include "capture/session.h"

#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "layer/log.h"

#ifndef MAP_FIXED_NOREPLACE
#define MAP_FIXED_NOREPLACE 0x100000
#endif

namespace a2rt::layer {
namespace {

constexpr std::uint64_t kHeaderAddress = 0x500000000000;
constexpr std::size_t kHeaderBytes = 4096;
constexpr int kHeaderAttempts = 16;
constexpr const char* kRecordsName = "records.bin";
constexpr const char* kManifestName = "manifest.bin";

}  // namespace

HeaderPage::HeaderPage() {
  // A page may be in the way (a second device of the process, an unlucky library).
  for (int attempt = 0; attempt < kHeaderAttempts && header_ == nullptr; ++attempt) {
    auto* const wanted =
        reinterpret_cast<void*>(kHeaderAddress + static_cast<std::uint64_t>(attempt) * (1 << 20));
    void* got = ::mmap(wanted, kHeaderBytes, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    if (got == wanted) {
      header_ = static_cast<capture::RecordHeader*>(got);
    } else if (got != MAP_FAILED) {
      ::munmap(got, kHeaderBytes);
    }
  }
  if (header_ == nullptr) {
    throw std::runtime_error(std::string("cannot map the header page: ") + std::strerror(errno));
  }
  *header_ = {};
}

HeaderPage::~HeaderPage() { ::munmap(header_, kHeaderBytes); }

OrdinalTable::~OrdinalTable() { release(); }

void OrdinalTable::release() {
  if (memory_ != nullptr) {
    ::munmap(memory_, bytes_);
    memory_ = nullptr;
  }
}

void OrdinalTable::prepare(capture::RecordHeader& header, std::uint64_t launches, bool zero) {
  if (memory_ == nullptr || launches > launches_) {
    release();
    bytes_ = static_cast<std::size_t>((launches + 1) * sizeof(std::uint32_t));
    memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory_ == MAP_FAILED) {
      memory_ = nullptr;
      throw std::runtime_error("cannot reserve ordinals for " + std::to_string(launches) +
                               " launch ids: " + std::strerror(errno));
    }
    launches_ = launches;
  } else if (zero) {
    std::memset(memory_, 0, static_cast<std::size_t>(launches + 1) * sizeof(std::uint32_t));
  }
  header.ordinals = reinterpret_cast<std::uint64_t>(memory_);
  header.ordinal_launches = static_cast<std::uint32_t>(launches_);
}

Session::Session(const Settings& settings)
    : settings_(settings), spare_(capture::kSpareUnits * capture::kUnitBytes + 16) {
  const auto spare = reinterpret_cast<std::uint64_t>(spare_.data());
  header_->records = (spare + 15) / 16 * 16;
  ordinals_.prepare(*header_, 1, true);
  if (!settings.verdict_file.empty()) {
    verdicts_.emplace(settings.verdict_file);
    info("verdicts for " + std::to_string(verdicts_->dispatches()) + " dispatches from " +
         settings.verdict_file);
  }
  if (settings.capturing()) {
    std::error_code error;
    std::filesystem::create_directories(settings.capture_directory, error);
    if (error) {
      throw std::runtime_error("cannot create the capture directory " + settings.capture_directory +
                               ": " + error.message());
    }
    // An older capture must not be taken for this one.
    std::filesystem::remove(final_name(kManifestName), error);
    std::filesystem::remove(final_name(kRecordsName), error);
    records_ = std::make_unique<RecordStream>(part(kRecordsName), settings.limit_bytes,
                                              settings.memory_bytes, *header_);
    manifest_ = std::make_unique<ManifestWriter>(part(kManifestName));
  }
}

Session::~Session() = default;

std::string Session::part(const char* name) const { return final_name(name) + ".part"; }

std::string Session::final_name(const char* name) const {
  return (std::filesystem::path(settings_.capture_directory) / name).string();
}

spirv::InstrumentOptions Session::instrument_options(std::uint32_t first_shader_index) const {
  spirv::InstrumentOptions options;
  options.header_address = header_.address();
  options.rays = capturing() && settings_.records.rays;
  options.results = capturing() && settings_.records.results;
  options.candidates = capturing() && settings_.records.candidates;
  options.counters = capturing() && settings_.counters;
  options.verdicts = verdicts_.has_value();
  options.first_shader_index = first_shader_index;
  options.site_limit = settings_.site_limit;
  return options;
}

void Session::use_verdicts(std::uint32_t dispatch) {
  const DispatchVerdicts* tables = verdicts_ ? verdicts_->find(dispatch) : nullptr;
  if (tables == nullptr || tables->entries.empty()) {
    header_->verdict_launches = 0;
    header_->verdict_index = 0;
    header_->verdicts = 0;
    return;
  }
  header_->verdict_index = reinterpret_cast<std::uint64_t>(tables->index.data());
  header_->verdicts = reinterpret_cast<std::uint64_t>(tables->entries.data());
  header_->verdict_launches = static_cast<std::uint32_t>(tables->index.size());
}

std::uint32_t Session::begin_dispatch(capture::DispatchBlock block,
                                      const std::vector<capture::SiteBinding>& bindings) {
  quiesce();
  const std::uint32_t dispatch = dispatches_++;
  constexpr std::uint32_t kDraw = 2;
  const std::uint64_t launches = std::uint64_t{block.width} * block.height * block.depth;
  ordinals_.prepare(*header_, launches, block.kind == kDraw);
  header_->launch_width = block.width;
  header_->dispatch = dispatch;
  use_verdicts(dispatch);
  if (manifest_ != nullptr) {
    block.dispatch = dispatch;
    block.first_unit = records_->used_units();
    manifest_->write(capture::BlockType::kDispatch, {bytes_of(block), bytes_of(bindings)});
  }
  return dispatch;
}

void Session::quiesce() {
  if (records_ != nullptr) {
    records_->quiesce();
  }
}

void Session::abandon(const std::string& why) {
  if (finished_) {
    return;
  }
  finished_ = true;
  if (!capturing()) {
    return;
  }
  warn("no capture in " + settings_.capture_directory + ": " + why);
  records_.reset();
  manifest_->close();
  std::error_code ignored;
  std::filesystem::remove(part(kRecordsName), ignored);
  std::filesystem::remove(part(kManifestName), ignored);
}

void Session::finish() {
  if (finished_ || !capturing()) {
    return;
  }
  if (dispatches_ == 0) {
    abandon("the program traced no rays that the layer could see");
    return;
  }
  try {
    capture::EndBlock end{records_->finish(), header_->lost};
    manifest_->write(capture::BlockType::kEnd, {bytes_of(end)});
    manifest_->close();
    if (manifest_->failed()) {
      abandon("its manifest could not be written");
      return;
    }
    // The manifest gets its name last: where it stands, everything is there.
    std::filesystem::rename(part(kRecordsName), final_name(kRecordsName));
    std::filesystem::rename(part(kManifestName), final_name(kManifestName));
    finished_ = complete_ = true;
    if (end.lost_records != 0) {
      warn(std::to_string(end.lost_records) +
           " records did not fit and are lost; raise A2RT_LIMIT or free space on the disk of " +
           settings_.capture_directory);
    }
    info("captured " + std::to_string(dispatches_) + " dispatches, " +
         std::to_string(end.units * capture::kUnitBytes) + " bytes of records in " +
         settings_.capture_directory);
  } catch (const std::exception& error) {
    abandon(error.what());
  }
}

}  // namespace a2rt::layer
