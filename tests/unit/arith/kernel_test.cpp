// The eight-wide kernels give the same bits as the scalar definitions.
#include <gtest/gtest.h>

#include <bit>

#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"
#include "a2rt/hard/strata.h"
#include "properties.h"

namespace a2rt::arith::testing {
namespace {

using namespace a2rt::hard;

TEST(SlabBlock, IsBitEqualToTheScalarTest) {
  Random random(11);
  for (std::uint32_t i = 0; i < 60'000; ++i) {
    const Stratum s = stratum(i % kStrata);
    const TestGroup group = make_group(random, s);
    const TestRay ray = make_ray(random, s, group);
    const SlabRay slab = make_slab_ray(ray.origin, ray.direction, ray.tmin);
    BoxBlock block;
    const std::size_t used = 1 + random.below(8);
    for (std::size_t slot = 0; slot < used; ++slot) {
      block.put(slot, group.children[slot]);
    }
    float entry[8];
    const std::uint32_t mask = slab_test_block(slab, block, ray.tmax, entry);
    for (std::size_t slot = 0; slot < used; ++slot) {
      const SlabHit hit = slab_test(slab, group.children[slot], ray.tmax);
      ASSERT_EQ((mask >> slot & 1U) != 0, hit.hit) << describe(ray);
      if (hit.hit) {
        ASSERT_EQ(entry[slot], hit.t_entry) << describe(ray);
      }
    }
  }
}

void expect_same(const GroupRay& a, const GroupRay& b, bool tables, const std::string& what) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ASSERT_EQ(a.near_origin[axis], b.near_origin[axis]) << what;
    ASSERT_EQ(a.far_origin[axis], b.far_origin[axis]) << what;
    ASSERT_EQ(a.near_rate[axis], b.near_rate[axis]) << what;
    ASSERT_EQ(a.far_rate[axis], b.far_rate[axis]) << what;
    if (tables) {
      ASSERT_EQ(a.near_unit[axis], b.near_unit[axis]) << what;
      ASSERT_EQ(a.far_unit[axis], b.far_unit[axis]) << what;
      ASSERT_EQ(a.near_row[axis], b.near_row[axis]) << what;
      ASSERT_EQ(a.far_row[axis], b.far_row[axis]) << what;
    }
  }
  ASSERT_EQ(a.t_shift, b.t_shift) << what;
  ASSERT_EQ(a.negative, b.negative) << what;
}

TEST(RayQuantizerVector, IsBitEqualToTheScalarCode) {
  Random random(9);
  std::uint64_t compared = 0;
  for (std::uint32_t i = 0; i < 60'000; ++i) {
    const Stratum s = stratum(i % kStrata);
    const auto& precisions = conservative_precisions();
    const A2rtPrecision& precision = precisions[i % precisions.size()];
    const TestGroup group = make_group(random, s);
    const TestRay ray = make_ray(random, s, group);
    const RayQuantizer quantizer(precision);
    const GroupFrame frame = make_group_frame(group.box, precision);
    const QuantizerRay q = make_quantizer_ray(ray.origin, ray.direction);
    const SlabHit entry =
        slab_test(make_slab_ray(ray.origin, ray.direction, ray.tmin), group.box, ray.tmax);
    GroupRay vector;
    GroupRay scalar;
    const GroupEntry result = quantizer.enter(q, frame, entry.t_entry, vector);
    ASSERT_EQ(result, quantizer.enter_scalar(q, frame, entry.t_entry, scalar)) << describe(ray);
    if (result == GroupEntry::kQuantized) {
      ++compared;
      const bool tables = precision.multiplier_columns > 0 && precision.direction.fp32_range();
      expect_same(vector, scalar, tables, name_of(precision) + " " + describe(ray));
    }
  }
  EXPECT_GT(compared, 20'000U);
}

// All precisions the vector kernels serve, including those without a guarantee.
std::vector<A2rtPrecision> kernel_precisions() {
  std::vector<A2rtPrecision> all = conservative_precisions();
  for (int k = 0; k <= 8; ++k) {
    A2rtPrecision p;
    p.multiplier_columns = k;
    p.low_columns = k % 2 == 0 ? LowColumns::kCompress : LowColumns::kDrop;
    all.push_back(p);
    p.origin = OriginDesign::kLiteral;
    all.push_back(p);
    p.origin = OriginDesign::kGuard;
    p.rounding = QuantRounding::kNearest;
    p.direction = reduced_significand(5 + k % 6);
    all.push_back(p);
    p.box_bits = 12;
    p.direction = reduced_significand(5);
    all.push_back(p);
  }
  return all;
}

TEST(QBoxKernel, IsBitEqualToTheReferenceForEveryPrecision) {
  std::uint64_t compared = 0;
  std::uint64_t hits = 0;
  for (const A2rtPrecision& precision : kernel_precisions()) {
    const QBoxTester tester(precision);
    const QBoxReference reference(precision);
    const RayQuantizer quantizer(precision);
    Random random(5);
    alignas(16) std::byte block[96];
    ASSERT_LE(tester.block_bytes(), sizeof block);
    for (std::uint32_t i = 0; i < 4'000; ++i) {
      const Stratum s = stratum(i * 7 % kStrata);
      const TestGroup group = make_group(random, s);
      const TestRay ray = make_ray(random, s, group);
      const SlabHit entry =
          slab_test(make_slab_ray(ray.origin, ray.direction, ray.tmin), group.box, ray.tmax);
      const GroupFrame frame = make_group_frame(group.box, precision);
      GroupRay local;
      if (!entry.hit || quantizer.enter(make_quantizer_ray(ray.origin, ray.direction), frame,
                                        entry.t_entry, local) != GroupEntry::kQuantized) {
        continue;
      }
      tester.clear(block);
      for (std::size_t slot = 0; slot < kChildren; ++slot) {
        const QuantizedBox q = quantize_box(group.children[slot], group.box, frame, precision);
        tester.put(block, slot, q);
        ASSERT_EQ(tester.get(block, slot), q);
      }
      const float left = quantizer.remaining(ray.tmax, entry.t_entry);
      float near[8];
      const std::uint32_t mask = tester.test(local, block, left, near);
      for (std::size_t slot = 0; slot < kChildren; ++slot) {
        const QBoxHit hit = reference.test(local, tester.get(block, slot), left);
        ASSERT_EQ((mask >> slot & 1U) != 0, hit.hit)
            << name_of(precision) << " " << name_of(s) << " " << describe(ray);
        if (hit.hit) {
          ASSERT_EQ(std::bit_cast<std::uint32_t>(near[slot]),
                    std::bit_cast<std::uint32_t>(hit.t_near))
              << name_of(precision) << " " << describe(ray);
          ++hits;
        }
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 500'000U);
  EXPECT_GT(hits, compared / 20);
}

TEST(QBoxKernel, ScalarKernelEqualsTheVectorKernel) {
  const QBoxTester scalar(A2rtPrecision{}, false);
  EXPECT_FALSE(scalar.uses_simd());
  EXPECT_EQ(scalar.block_bytes(), 48U);
  A2rtPrecision twelve;
  twelve.box_bits = 12;
  EXPECT_EQ(QBoxTester(twelve).block_bytes(), 96U);
}

}  // namespace
}  // namespace a2rt::arith::testing
