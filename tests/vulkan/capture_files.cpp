#include "capture_files.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace a2rt::test {
namespace {

using capture::BlockType;
using capture::RecordKind;

std::vector<std::byte> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) {
    throw std::runtime_error("cannot open " + path);
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

class Cursor {
 public:
  explicit Cursor(const std::vector<std::byte>& bytes) : bytes_(bytes) {}
  template <class T>
  T take() {
    T value{};
    copy(&value, sizeof(T));
    return value;
  }
  template <class T>
  std::vector<T> take(std::size_t count) {
    std::vector<T> values(count);
    copy(values.data(), count * sizeof(T));
    return values;
  }
  std::string take_string() {
    const auto text = take<char>(take<std::uint32_t>());
    return {text.begin(), text.end()};
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  void copy(void* target, std::size_t count) {
    if (count > left()) {
      throw std::runtime_error("a block of the manifest is too short");
    }
    if (count != 0) {
      std::memcpy(target, bytes_.data() + at_, count);
    }
    at_ += count;
  }
  const std::vector<std::byte>& bytes_;
  std::size_t at_ = 0;
};

void expect_end(const Cursor& cursor, const char* what) {
  if (cursor.left() != 0) {
    throw std::runtime_error(std::string(what) + " has bytes left");
  }
}

CapturedStructure read_structure(const Block& block) {
  Cursor cursor(block.payload);
  CapturedStructure out;
  out.block = cursor.take<capture::AsBlock>();
  out.top_level = block.type == BlockType::kTlas;
  if (out.top_level) {
    out.instances = cursor.take<capture::InstanceBlock>(out.block.count);
  } else {
    out.geometries = cursor.take<capture::GeometryBlock>(out.block.geometry_count);
    const bool boxes = !out.geometries.empty() && out.geometries[0].type == 1;
    out.primitives = cursor.take<float>(std::size_t{out.block.count} * (boxes ? 6 : 9));
  }
  cursor.take<std::byte>(out.block.node_bytes);
  expect_end(cursor, "a structure");
  return out;
}

void interpret(const Block& block, CaptureFiles& files) {
  Cursor cursor(block.payload);
  switch (block.type) {
    case BlockType::kDispatch: {
      CapturedDispatch dispatch;
      dispatch.block = cursor.take<capture::DispatchBlock>();
      dispatch.bindings = cursor.take<capture::SiteBinding>(dispatch.block.site_count);
      expect_end(cursor, "a dispatch");
      files.dispatches.push_back(std::move(dispatch));
      break;
    }
    case BlockType::kBlas:
    case BlockType::kTlas:
      files.structures.push_back(read_structure(block));
      break;
    case BlockType::kAsCopy:
      files.copies.push_back(cursor.take<capture::AsCopyBlock>());
      break;
    case BlockType::kRefused:
      files.refused.push_back(cursor.take_string());
      break;
    case BlockType::kShader:
      ++files.shaders;
      break;
    case BlockType::kEnd:
      files.end = cursor.take<capture::EndBlock>();
      break;
    default:
      break;
  }
}

std::uint32_t units_of(RecordKind kind) {
  switch (kind) {
    case RecordKind::kRay:
      return capture::kRayUnits;
    case RecordKind::kHit:
      return capture::kHitUnits;
    case RecordKind::kMiss:
      return capture::kMissUnits;
    case RecordKind::kAnyHit:
      return capture::kAnyHitUnits;
    case RecordKind::kReport:
      return capture::kReportUnits;
    case RecordKind::kEnd:
      return capture::kEndUnits;
    case RecordKind::kSegment:
      return capture::kSegmentUnits;
    case RecordKind::kQueryStep:
      return capture::kQueryStepUnits;
    case RecordKind::kQueryVerdict:
      return capture::kQueryVerdictUnits;
  }
  throw std::runtime_error("unknown record kind " +
                           std::to_string(static_cast<std::uint32_t>(kind)));
}

// What is known of one launch id while its records pass in program order.
struct Launch {
  bool open_ray = false;  // a ray without result yet
  bool any_ray = false;
};

void account(RecordKind kind, const std::uint32_t* words, Launch& launch, RecordCounts& counts) {
  ++counts.kinds[kind];
  switch (kind) {
    case RecordKind::kRay:
      launch = {true, true};
      ++counts.rays_per_site[words[14]];
      counts.largest_ordinal = std::max<std::uint64_t>(counts.largest_ordinal, words[3]);
      break;
    case RecordKind::kHit:
    case RecordKind::kMiss:
      counts.orphans += launch.open_ray ? 0 : 1;
      launch.open_ray = false;
      break;
    case RecordKind::kAnyHit:
    case RecordKind::kReport:
      counts.orphans += launch.open_ray ? 0 : 1;
      break;
    case RecordKind::kQueryStep:
    case RecordKind::kQueryVerdict:
      counts.orphans += launch.any_ray ? 0 : 1;
      break;
    case RecordKind::kEnd:
    case RecordKind::kSegment:
      break;
  }
}

}  // namespace

std::uint64_t CaptureFiles::count(BlockType type) const {
  return static_cast<std::uint64_t>(std::count_if(
      blocks.begin(), blocks.end(), [type](const Block& b) { return b.type == type; }));
}

CaptureFiles read_capture(const std::string& folder) {
  CaptureFiles files;
  const auto manifest = read_file(folder + "/manifest.bin");
  Cursor cursor(manifest);
  if (cursor.take<std::uint32_t>() != capture::kManifestMagic ||
      cursor.take<std::uint32_t>() != capture::kFormatVersion) {
    throw std::runtime_error("not a manifest");
  }
  while (cursor.left() != 0) {
    const auto header = cursor.take<capture::BlockHeader>();
    files.blocks.push_back(
        {static_cast<BlockType>(header.type), cursor.take<std::byte>(header.bytes)});
    interpret(files.blocks.back(), files);
  }
  if (files.blocks.empty() || files.blocks.back().type != BlockType::kEnd) {
    throw std::runtime_error("the manifest has no end");
  }
  const auto records = read_file(folder + "/records.bin");
  if (records.size() != files.end.units * capture::kUnitBytes) {
    throw std::runtime_error("records.bin does not have the size that the manifest says");
  }
  files.records.resize(records.size() / sizeof(std::uint32_t));
  std::memcpy(files.records.data(), records.data(), records.size());
  return files;
}

void visit_records(const CaptureFiles& files,
                   const std::function<void(const std::uint32_t*)>& visit) {
  for (std::uint64_t unit = 0; unit < files.end.units;) {
    const std::uint32_t* words = files.records.data() + unit * 4;
    visit(words);
    unit += units_of(static_cast<RecordKind>(words[0] & 0xffu));
  }
}

RecordCounts count_records(const CaptureFiles& files) {
  RecordCounts counts;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Launch> launches;
  for (std::uint64_t unit = 0; unit < files.end.units;) {
    const std::uint32_t* words = files.records.data() + unit * 4;
    const auto kind = static_cast<RecordKind>(words[0] & 0xffu);
    const std::uint32_t dispatch = words[2];
    bool stray = dispatch >= files.dispatches.size() || words[0] >> 16 >= files.shaders;
    if (!stray) {
      const capture::DispatchBlock& block = files.dispatches[dispatch].block;
      const bool last = dispatch + 1 == files.dispatches.size();
      stray = unit < block.first_unit ||
              (!last && unit >= files.dispatches[dispatch + 1].block.first_unit) ||
              words[1] >= block.width * block.height * block.depth;
    }
    counts.strays += stray ? 1 : 0;
    account(kind, words, launches[{dispatch, words[1]}], counts);
    unit += units_of(kind);
  }
  return counts;
}

}  // namespace a2rt::test
