#include "spirv/counters.h"

namespace a2rt::spirv {

Counters::Counters(TypePool& types, bool enabled) : enabled_(enabled) {
  if (enabled) {
    const Id zero = types.composite(types.uvec_type(4), {0, 0, 0, 0});
    for (Id& half : halves_) {
      half = types.variable(spv::StorageClass::Private, types.uvec_type(4), zero);
    }
  }
}

std::vector<Id> Counters::variables() const {
  return enabled_ ? std::vector<Id>(halves_.begin(), halves_.end()) : std::vector<Id>{};
}

void Counters::clear(CodeBuilder& code) const {
  if (enabled_) {
    const Id zero = code.types().composite(code.types().uvec_type(4), {0, 0, 0, 0});
    for (const Id half : halves_) {
      code.store(half, zero);
    }
  }
}

void Counters::flush(CodeBuilder& code, Weights& pending) const {
  for (std::size_t h = 0; enabled_ && h < halves_.size(); ++h) {
    const auto first = pending.count.begin() + static_cast<std::ptrdiff_t>(4 * h);
    const std::vector<std::uint32_t> part(first, first + 4);
    if (part == std::vector<std::uint32_t>(4, 0)) {
      continue;
    }
    const Id type = code.types().uvec_type(4);
    const Id before = code.load(type, halves_[h]);
    code.store(halves_[h],
               code.emit(spv::Op::OpIAdd, type, {before, code.types().composite(type, part)}));
  }
  pending = {};
}

std::array<Id, Counters::kHalves> Counters::take(CodeBuilder& code) const {
  const Id type = code.types().uvec_type(4);
  const Id zero = code.types().composite(type, {0, 0, 0, 0});
  std::array<Id, kHalves> units{};
  for (std::size_t h = 0; h < kHalves; ++h) {
    units[h] = enabled_ ? code.load(type, halves_[h]) : zero;
  }
  clear(code);
  return units;
}

}  // namespace a2rt::spirv
