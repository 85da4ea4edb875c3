#include "a2rt/arith/qbox.h"

#include <cmath>
#include <cstring>

#include "a2rt/base/error.h"
#include "qbox_tables.h"

namespace a2rt::arith {
namespace {

constexpr std::size_t kAxes = 3;
constexpr std::size_t kWidth = QBoxTester::kWidth;

// Blocks are lo[3][8] then hi[3][8], one or two bytes a plane.
std::uint16_t load_plane(const std::byte* block, std::size_t index, bool wide) {
  if (!wide) {
    return std::to_integer<std::uint16_t>(block[index]);
  }
  std::uint16_t value = 0;
  std::memcpy(&value, block + 2 * index, sizeof value);
  return value;
}

void store_plane(std::byte* block, std::size_t index, std::uint16_t value, bool wide) {
  if (!wide) {
    block[index] = static_cast<std::byte>(value);
    return;
  }
  std::memcpy(block + 2 * index, &value, sizeof value);
}

QuantizedBox load_box(const std::byte* block, std::size_t slot, bool wide) {
  QuantizedBox box;
  for (std::size_t a = 0; a < kAxes; ++a) {
    box.lo[a] = load_plane(block, a * kWidth + slot, wide);
    box.hi[a] = load_plane(block, (kAxes + a) * kWidth + slot, wide);
  }
  return box;
}

template <bool kWide>
std::uint32_t scalar_entry(const QBoxTester::Tables& tables, const GroupRay& ray,
                           const std::byte* block, float t_left, float* t_near) {
  return scalar_kernel(tables, ray, block, t_left, t_near, kWide);
}

}  // namespace

QBoxHit QBoxReference::test(const GroupRay& ray, const QuantizedBox& box, float t_left) const {
  float near = 0;
  float far = t_left;
  for (std::size_t a = 0; a < kAxes; ++a) {
    bool negative = (ray.negative >> a & 1U) != 0;
    if (mutant(Mutant::kQBoxNegativeDirectionSwapsPlanes)) {
      negative = false;
    }
    int near_origin = static_cast<int>(ray.near_origin[a]);
    int far_origin = static_cast<int>(ray.far_origin[a]);
    if (mutant(Mutant::kQBoxUsesWrongOriginBound)) {
      std::swap(near_origin, far_origin);
    }
    const int ahead = negative ? near_origin - box.hi[a] : box.lo[a] - near_origin;
    const int behind = negative ? far_origin - box.lo[a] : box.hi[a] - far_origin;
    if (behind < 0) {
      return {};
    }
    const float rate_near = std::fabs(ray.near_rate[a]);
    const float rate_far = std::fabs(ray.far_rate[a]);
    near = std::fmax(
        near, multiplier_.near(static_cast<std::uint32_t>(ahead > 0 ? ahead : 0), rate_near));
    far = std::fmin(far, multiplier_.far(static_cast<std::uint32_t>(behind), rate_far));
  }
  return {mutant(Mutant::kQBoxStrictCompare) ? near < far : near <= far, near};
}

QBoxTester::Tables::Tables(const A2rtPrecision& precision)
    : reference(precision), columns(precision.multiplier_columns) {
  const int p = precision.direction.significand_bits;
  if (!precision.direction.fp32_range() || p > 10) {
    return;
  }
  dropped_bits = (1U << (24 - p)) - 1;
  low_mask = (1U << columns) - 1;
  if (columns == 0) {
    return;
  }
  const ApproxMultiplier multiplier(precision.magnitude_bits(), p, columns, precision.low_columns);
  const std::uint32_t hidden = 1U << (p - 1);
  const std::uint32_t row = columns <= 4 ? 16U : 1U << columns;
  for (std::uint32_t b = hidden; b < 2 * hidden; ++b) {
    for (std::uint32_t entry = 0; entry < row; ++entry) {
      const std::uint32_t magnitude = entry & low_mask;
      const std::uint64_t exact = static_cast<std::uint64_t>(magnitude) * b;
      const auto loss = static_cast<std::int32_t>(exact - multiplier.low(magnitude, b));
      const auto gain = static_cast<std::int32_t>(multiplier.high(magnitude, b) - exact);
      if (columns <= 4) {
        A2RT_CHECK(loss <= 127 && gain <= 127, "correction does not fit a byte");
        near_bytes.push_back(static_cast<std::int8_t>(loss));
        far_bytes.push_back(static_cast<std::int8_t>(gain));
      } else {
        near_words.push_back(loss);
        far_words.push_back(gain);
      }
    }
  }
}

std::uint32_t scalar_kernel(const QBoxTester::Tables& tables, const GroupRay& ray,
                            const std::byte* block, float t_left, float* t_near, bool wide) {
  std::uint32_t mask = 0;
  for (std::size_t slot = 0; slot < kWidth; ++slot) {
    const QBoxHit hit = tables.reference.test(ray, load_box(block, slot, wide), t_left);
    mask |= hit.hit ? 1U << slot : 0U;
    t_near[slot] = hit.t_near;
  }
  return mask;
}

QBoxTester::QBoxTester(const A2rtPrecision& precision, bool allow_simd)
    : wide_(precision.box_bits > 8),
      tables_(std::make_shared<const Tables>(precision)),
      kernel_(wide_ ? &scalar_entry<true> : &scalar_entry<false>) {
  precision.validate();
  const Kernel fast = allow_simd ? vector_kernel(precision) : nullptr;
  if (fast != nullptr) {
    kernel_ = fast;
    simd_ = true;
  }
}

void QBoxTester::clear(std::byte* block) const {
  const auto last = static_cast<std::uint16_t>(wide_ ? 0xFFF : 0xFF);
  for (std::size_t slot = 0; slot < kWidth; ++slot) {
    put(block, slot, QuantizedBox{{last, last, last}, {0, 0, 0}});
  }
}

void QBoxTester::put(std::byte* block, std::size_t slot, const QuantizedBox& box) const {
  for (std::size_t a = 0; a < kAxes; ++a) {
    store_plane(block, a * kWidth + slot, box.lo[a], wide_);
    store_plane(block, (kAxes + a) * kWidth + slot, box.hi[a], wide_);
  }
}

QuantizedBox QBoxTester::get(const std::byte* block, std::size_t slot) const {
  return load_box(block, slot, wide_);
}

}  // namespace a2rt::arith
