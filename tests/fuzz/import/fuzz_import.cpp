// Structure-aware fuzzing of the importer: the input edits a valid capture, so that damage reaches
// deep into blocks and records instead of failing at the magic number.
//
// Input: a list of {u16 place, u8 target, u8 value}. Targets 0 and 1 overwrite a byte of manifest
// or records, 2 and 3 cut them off there, 4 adds a whole record of kind value % 10.
#include <cstdint>
#include <cstring>

#include "a2rt/base/error.h"
#include "a2rt/workload/check.h"
#include "a2rt/workload/synthetic.h"
#include "raw_capture.h"

namespace {

using namespace a2rt;
using testing::Bytes;

struct Seed {
  Bytes manifest, records;
};

Seed make_seed() {
  synthetic::Config config;
  config.primitives = 6;
  config.width = config.height = 2;
  config.driver_nodes = true;
  config.masked_share = 0.5;
  const Workload scene = synthetic::make(config);
  testing::RawRecords records;
  records.by(capture::Stage::kRayGeneration, 0).ray(scene.rays[0]);
  records.by(capture::Stage::kAnyHit, 3).any_hit({HitState::kHit, 1, 0, 1, 0, 0xFE}, {}).end();
  records.by(capture::Stage::kClosestHit, 1).hit({HitState::kHit, 1, 0, 1, 0, 0xFE});
  records.ray(scene.rays[1]).end();
  records.by(capture::Stage::kRayGeneration, 0).end();
  records.by(capture::Stage::kCompute, 6, 1).ray(scene.rays[2]).step({}, true);
  records.query_verdict({HitState::kHit, 1, 0, 1, 1, 0xFE}, false, {}).step({}, false).end();
  testing::RawManifest manifest;
  manifest.driver("program");
  for (std::uint32_t i = 0; i < 7; ++i) {
    manifest.shader(i, static_cast<capture::Stage>(i));
  }
  manifest.blas(1, 0x1000, scene.blas[0]);
  manifest.tlas(2, 0x2000, scene.tlas[0], {0x1000});
  manifest.dispatch(2, 2, 0, {{0, 0, 2}});
  manifest.end(records.units());
  return {manifest.bytes(), records.bytes()};
}

void edit(Seed& seed, std::uint16_t place, std::uint8_t target, std::uint8_t value) {
  Bytes& bytes = target % 2 == 0 ? seed.manifest : seed.records;
  if (bytes.empty()) {
    return;
  }
  const std::size_t at = place % bytes.size();
  switch (target % 5) {
    case 0:
    case 1:
      bytes[at] = static_cast<std::byte>(value);
      return;
    case 2:
    case 3:
      bytes.resize(at);
      return;
    default: {
      const std::uint32_t words[4] = {value % 10u, place % 4u, 0, 0};
      Bytes record(6 * capture::kUnitBytes);
      std::memcpy(record.data(), words, sizeof words);
      seed.records.insert(seed.records.end(), record.begin(), record.end());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Seed kSeed = make_seed();
  Seed seed = kSeed;
  for (std::size_t i = 0; i + 4 <= size; i += 4) {
    edit(seed, static_cast<std::uint16_t>(data[i] | data[i + 1] << 8), data[i + 2], data[i + 3]);
  }
  try {
    ImportOptions options;
    options.tolerate_lost = true;
    ImportReport report;
    const Workload workload = import_capture(seed.manifest, seed.records, options, report);
    CheckOptions check;
    check.threads = 1;
    check_workload(workload, check);
  } catch (const UserError&) {
    // The one answer to damage.
  }
  return 0;
}
