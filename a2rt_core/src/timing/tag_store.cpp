#include "a2rt/timing/tag_store.h"

#include <string>

#include "a2rt/base/error.h"

namespace a2rt::timing {

TagStore::TagStore(Bytes capacity, std::uint32_t ways, const char* name) {
  const std::uint64_t lines = capacity.value / kLineBytes;
  const std::uint64_t per_set = ways == 0 ? lines : ways;
  if (lines == 0 || capacity.value % kLineBytes != 0 || lines % per_set != 0) {
    throw UserError(std::string(name) + ": capacity of " + std::to_string(capacity.value) +
                    " bytes is not a whole number of sets of " + std::to_string(per_set) +
                    " lines of " + std::to_string(kLineBytes) + " bytes; change capacity or ways");
  }
  if (per_set <= PackedSets::kMostWays) {
    packed_.emplace(lines / per_set, static_cast<std::uint32_t>(per_set));
  } else {
    hashed_.emplace(lines / per_set, static_cast<std::uint32_t>(per_set));
  }
}

}  // namespace a2rt::timing
