// Reads a raw capture for the tests: strict, independent of the importer.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "a2rt/capture/manifest.h"
#include "a2rt/capture/records.h"

namespace a2rt::test {

struct Block {
  capture::BlockType type;
  std::vector<std::byte> payload;
};

struct CapturedDispatch {
  capture::DispatchBlock block;
  std::vector<capture::SiteBinding> bindings;
};

struct CapturedStructure {
  capture::AsBlock block;
  bool top_level = false;
  std::vector<capture::InstanceBlock> instances;
  std::vector<capture::GeometryBlock> geometries;
  std::vector<float> primitives;
};

struct RecordCounts {
  std::map<capture::RecordKind, std::uint64_t> kinds;
  std::uint64_t orphans = 0;  // results and candidates without a ray
  std::uint64_t strays = 0;   // records outside their dispatch's range or launch size
  std::map<std::uint32_t, std::uint64_t> rays_per_site;
  std::uint64_t largest_ordinal = 0;
};

struct CaptureFiles {
  std::vector<Block> blocks;
  std::vector<CapturedDispatch> dispatches;
  std::vector<CapturedStructure> structures;
  std::vector<capture::AsCopyBlock> copies;
  std::vector<std::string> refused;
  std::uint32_t shaders = 0;
  capture::EndBlock end{};
  std::vector<std::uint32_t> records;  // four words a unit

  std::uint64_t count(capture::BlockType type) const;
};

// Throws std::runtime_error if anything is missing or inconsistent.
CaptureFiles read_capture(const std::string& folder);
RecordCounts count_records(const CaptureFiles& files);
// Calls `visit` with the words of each record, in the order of the file.
void visit_records(const CaptureFiles& files,
                   const std::function<void(const std::uint32_t*)>& visit);

}  // namespace a2rt::test
