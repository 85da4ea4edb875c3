// The simulated GPU's memory map: which structure lies where. Regions never overlap.
#pragma once

#include <string>
#include <vector>

#include "a2rt/base/units.h"

namespace a2rt::bvh {

struct Region {
  std::string name;
  Address base;
  Bytes bytes;
};

class AddressSpace {
 public:
  // Every region starts at a multiple of `alignment` (a power of two; a cache line by default, so
  // that two structures never share one).
  explicit AddressSpace(Bytes alignment = Bytes{128});
  // Throws UserError for an alignment that is no power of two.
  Address reserve(const std::string& name, Bytes bytes);
  const std::vector<Region>& regions() const { return regions_; }

 private:
  std::uint64_t alignment_;
  std::uint64_t next_;
  std::vector<Region> regions_;
};

}  // namespace a2rt::bvh
