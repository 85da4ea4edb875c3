// Acceleration structures over the time of a capture: which version did each dispatch trace?
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "a2rt/capture/manifest.h"
#include "a2rt/workload/workload.h"

namespace a2rt::import {

struct RawInstance {
  Instance instance;
  std::uint64_t blas_address = 0;
};
struct RawTlas {
  std::vector<RawInstance> instances;
  std::vector<std::byte> driver_nodes;
};

// Fed with the blocks of the manifest in their order. Structures that no dispatch uses never reach
// the workload.
class SceneTimeline {
 public:
  explicit SceneTimeline(Workload& workload) : workload_(workload) {}

  void add_blas(const capture::AsBlock& block, Blas blas);
  void add_tlas(const capture::AsBlock& block, RawTlas tlas);
  // A TLAS that no longer exists is not the one that a trace by address means.
  void destroy(std::uint64_t address);
  // Returns false if nothing is known at the source address.
  bool copy(const capture::AsCopyBlock& block);

  // Index into Workload::tlas of TLAS `id` as it is now, with the BLASes its instances refer to as
  // they are now. id 0: the only TLAS alive. Returns kNone if it is not known or not unique.
  std::uint32_t resolve(std::uint64_t id);

 private:
  struct BuiltBlas {
    Blas blas;
    std::uint32_t index = kNone;  // in the workload, once used
  };
  struct BuiltTlas {
    RawTlas raw;
    std::uint32_t index = kNone;         // in the workload, of the version last used
    std::vector<std::uint32_t> blas_of;  // per instance, in that version
    std::uint64_t epoch = 0;             // of that version
  };
  std::uint32_t blas_index(std::uint64_t address);

  Workload& workload_;
  std::vector<BuiltBlas> blas_;
  std::vector<BuiltTlas> tlas_;
  std::map<std::uint64_t, std::size_t> blas_at_, tlas_at_;  // by address: what lives there now
  std::map<std::uint64_t, std::size_t> tlas_by_id_;
  std::uint64_t epoch_ = 1;  // raised by every change of a BLAS
};

}  // namespace a2rt::import
