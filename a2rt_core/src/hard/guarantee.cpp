#include "a2rt/hard/guarantee.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <memory>
#include <thread>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/arith/oracle.h"
#include "a2rt/arith/pow2_frame.h"
#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"

namespace a2rt::hard {
namespace {

// This file is about the arithmetic alone.
using namespace arith;

constexpr std::size_t kBlocks = 4;  // of eight boxes per group
constexpr std::size_t kRaysPerGroup = 32;

// One group with its boxes, one ray, and the exact answers.
struct Situation {
  Box group;
  std::array<std::array<Box, kChildren>, kBlocks> boxes;
  TestRay ray;
  bool ray_meets_group = false;
  std::array<std::uint32_t, kBlocks> exact{};  // bit per box
};

void count_masks(Counts& counts, const Situation& now, std::size_t block, std::uint32_t mask,
                 bool escaped) {
  const std::uint32_t exact = now.exact[block];
  const auto ones = [](std::uint32_t x) { return static_cast<std::uint64_t>(std::popcount(x)); };
  const std::uint32_t lost = exact & ~mask & 0xFFU;
  if (escaped) {
    counts.escaped += kChildren;
    counts.escaped_missed += ones(lost);
  } else {
    counts.tests += kChildren;
    counts.hits += ones(exact);
    counts.missed += ones(lost);
    counts.redundant += ones(mask & ~exact & 0xFFU);
  }
  if (lost != 0 && counts.first_missed.empty()) {
    const auto slot = static_cast<std::size_t>(std::countr_zero(lost));
    counts.first_missed = describe(now.ray) + ", group " + describe(now.group) + ", child " +
                          describe(now.boxes[block][slot]);
  }
}

// The group test said no: whatever the boxes hold is lost.
void count_group_miss(Counts& counts, const Situation& now) {
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const auto lost = static_cast<std::uint64_t>(std::popcount(now.exact[b]));
    counts.group_missed += lost;
    if (lost > 0 && counts.first_missed.empty()) {
      counts.first_missed = "group test: " + describe(now.ray) + ", group " + describe(now.group);
    }
  }
}

class Player {
 public:
  virtual ~Player() = default;
  virtual void encode(const Situation& now) = 0;
  virtual void play(const Situation& now, const SlabRay& slab, Counts& counts) = 0;
};

class A2rtPlayer : public Player {
 public:
  explicit A2rtPlayer(const A2rtPrecision& precision)
      : precision_(precision), quantizer_(precision), tester_(precision) {}

  void encode(const Situation& now) override {
    frame_ = make_group_frame(now.group, precision_);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      for (std::size_t c = 0; c < kChildren; ++c) {
        const QuantizedBox q = quantize_box(now.boxes[b][c], now.group, frame_, precision_);
        tester_.put(blocks_[b], c, q);
        dequantized_[b].put(c, dequantize_box(q, frame_, precision_));
      }
    }
  }

  void play(const Situation& now, const SlabRay& slab, Counts& counts) override {
    const bool literal = precision_.origin == OriginDesign::kLiteral;
    const SlabHit entry = literal ? slab_test_plain(slab, now.group, now.ray.tmax)
                                  : slab_test(slab, now.group, now.ray.tmax);
    if (!entry.hit) {
      count_group_miss(counts, now);
      return;
    }
    GroupRay local;
    const GroupEntry how = quantizer_.enter(make_quantizer_ray(now.ray.origin, now.ray.direction),
                                            frame_, entry.t_entry, local);
    const bool escaped = how == GroupEntry::kEscaped;
    const float left = quantizer_.remaining(now.ray.tmax, entry.t_entry);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      float near[kChildren];
      const std::uint32_t mask = escaped
                                     ? slab_test_block(slab, dequantized_[b], now.ray.tmax, near)
                                     : tester_.test(local, blocks_[b], left, near);
      count_masks(counts, now, b, mask, escaped);
    }
  }

 private:
  A2rtPrecision precision_;
  RayQuantizer quantizer_;
  QBoxTester tester_;
  GroupFrame frame_{};
  alignas(16) std::byte blocks_[kBlocks][48] = {};
  BoxBlock dequantized_[kBlocks];
};

class Aqb8Player : public Player {
 public:
  explicit Aqb8Player(Aqb8Rounding rounding) : rounding_(rounding) {}

  void encode(const Situation& now) override {
    usable_ = aqb8_can_anchor(now.group);
    if (!usable_) {
      return;  // such a box stays in its parent's cluster
    }
    anchor_ = make_aqb8_anchor(now.group);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      for (std::size_t c = 0; c < kChildren; ++c) {
        boxes_[b][c] = quantize_aqb8(now.boxes[b][c], anchor_);
      }
    }
  }

  void play(const Situation& now, const SlabRay&, Counts& counts) override {
    if (!usable_) {
      return;
    }
    const Aqb8Ray ray = make_aqb8_ray(now.ray.origin, now.ray.direction, now.ray.tmin);
    const Aqb8Entry entry = aqb8_anchor_test(ray, anchor_, now.ray.tmax);
    if (!entry.hit) {
      count_group_miss(counts, now);
      return;
    }
    const Aqb8Local local = aqb8_enter(ray, anchor_, entry.y_ref, now.ray.tmax, rounding_);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      std::uint32_t mask = 0;
      for (std::size_t c = 0; c < kChildren; ++c) {
        mask |= aqb8_test(ray, local, boxes_[b][c]).hit ? 1U << c : 0U;
      }
      count_masks(counts, now, b, mask, false);
    }
  }

 private:
  Aqb8Rounding rounding_;
  bool usable_ = false;
  Aqb8Anchor anchor_{};
  Aqb8Box boxes_[kBlocks][kChildren] = {};
};

class Pow2Player : public Player {
 public:
  void encode(const Situation& now) override {
    const Pow2Frame frame = make_pow2_frame(now.group);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      for (std::size_t c = 0; c < kChildren; ++c) {
        blocks_[b].put(c, dequantize_pow2(quantize_pow2(now.boxes[b][c], frame), frame));
      }
    }
  }
  void play(const Situation& now, const SlabRay& slab, Counts& counts) override {
    for (std::size_t b = 0; b < kBlocks; ++b) {
      float near[kChildren];
      count_masks(counts, now, b, slab_test_block(slab, blocks_[b], now.ray.tmax, near), false);
    }
  }

 private:
  BoxBlock blocks_[kBlocks];
};

std::array<std::unique_ptr<Player>, kDesigns> make_players() {
  A2rtPrecision guard;
  guard.origin = OriginDesign::kGuard;
  A2rtPrecision literal;
  literal.origin = OriginDesign::kLiteral;
  A2rtPrecision nearest;
  nearest.rounding = QuantRounding::kNearest;
  return {std::make_unique<A2rtPlayer>(A2rtPrecision{}),
          std::make_unique<A2rtPlayer>(guard),
          std::make_unique<A2rtPlayer>(literal),
          std::make_unique<A2rtPlayer>(nearest),
          std::make_unique<Aqb8Player>(Aqb8Rounding::kFloorCeil),
          std::make_unique<Aqb8Player>(Aqb8Rounding::kNearestEven),
          std::make_unique<Pow2Player>()};
}

void find_truth(Situation& now) {
  const OracleRay oracle(now.ray.origin, now.ray.direction, now.ray.tmin);
  now.ray_meets_group = ray_meets_box(oracle, now.group, now.ray.tmax);
  for (std::size_t b = 0; b < kBlocks; ++b) {
    now.exact[b] = 0;
    for (std::size_t c = 0; now.ray_meets_group && c < kChildren; ++c) {
      now.exact[b] |= ray_meets_box(oracle, now.boxes[b][c], now.ray.tmax) ? 1U << c : 0U;
    }
  }
}

GuaranteeResult run_worker(std::uint64_t least_tests, std::uint64_t seed) {
  GuaranteeResult result;
  Random random(seed);
  auto players = make_players();
  for (std::uint32_t round = 0;; ++round) {
    const auto number = static_cast<std::uint32_t>(std::uint64_t{round} * 253 % kStrata);
    const Stratum s = stratum(number);
    TestGroup group = make_group(random, s);
    Situation now;
    now.group = group.box;
    for (auto& block : now.boxes) {
      make_children(random, s, group);
      std::copy(group.children.begin(), group.children.end(), block.begin());
    }
    for (auto& player : players) {
      player->encode(now);
    }
    for (std::size_t r = 0; r < kRaysPerGroup; ++r) {
      now.ray = make_ray(random, s, group);
      if (!ray_is_active(now.ray.origin, now.ray.direction, now.ray.tmin, now.ray.tmax)) {
        continue;
      }
      find_truth(now);
      const SlabRay slab = make_slab_ray(now.ray.origin, now.ray.direction, now.ray.tmin);
      for (std::size_t d = 0; d < kDesigns; ++d) {
        players[d]->play(now, slab, result.counts[d][number]);
      }
    }
    // Whole sweeps over the strata, so that no stratum is favoured.
    if (round % kStrata == kStrata - 1 && result.total(Design::kWide).tests >= least_tests &&
        result.total(Design::kGuard).tests >= least_tests) {
      return result;
    }
  }
}

}  // namespace

std::string name_of(Design design) {
  static constexpr const char* kNames[] = {"a2rt wide",    "a2rt guard", "a2rt literal",
                                           "a2rt nearest", "aqb8 floor", "aqb8 rne",
                                           "cwbvh/clbvh"};
  return kNames[static_cast<std::size_t>(design)];
}

bool claims_no_miss(Design design) {
  return design == Design::kWide || design == Design::kGuard || design == Design::kPow2;
}

void Counts::add(const Counts& other) {
  tests += other.tests;
  hits += other.hits;
  missed += other.missed;
  redundant += other.redundant;
  escaped += other.escaped;
  escaped_missed += other.escaped_missed;
  group_missed += other.group_missed;
  if (first_missed.empty()) {
    first_missed = other.first_missed;
  }
}

double Counts::found() const {
  const std::uint64_t all = hits + group_missed;
  return all == 0 ? 1 : 1 - static_cast<double>(missed + group_missed) / static_cast<double>(all);
}

double Counts::redundant_share() const {
  const std::uint64_t misses = tests - hits;
  return misses == 0 ? 0 : static_cast<double>(redundant) / static_cast<double>(misses);
}

GuaranteeResult::GuaranteeResult() {
  for (std::vector<Counts>& c : counts) {
    c.resize(kStrata);
  }
}

Counts GuaranteeResult::total(Design design) const {
  Counts sum;
  for (const Counts& c : counts[static_cast<std::size_t>(design)]) {
    sum.add(c);
  }
  return sum;
}

void GuaranteeResult::add(const GuaranteeResult& other) {
  for (std::size_t d = 0; d < kDesigns; ++d) {
    for (std::size_t k = 0; k < counts[d].size(); ++k) {
      counts[d][k].add(other.counts[d][k]);
    }
  }
}

namespace {

// Adds a row for each kind of one dimension.
template <class Kind>
void add_rows(const GuaranteeResult& result, Design design, const char* dimension,
              Kind Stratum::*member, std::vector<GuaranteeRow>& rows) {
  const std::size_t first = rows.size();
  for (std::size_t k = 0; k < static_cast<std::size_t>(Kind::kCount); ++k) {
    rows.push_back({design, dimension, name_of(static_cast<Kind>(k)), {}});
  }
  for (std::uint32_t i = 0; i < kStrata; ++i) {
    const auto kind = static_cast<std::size_t>(stratum(i).*member);
    rows[first + kind].counts.add(result.counts[static_cast<std::size_t>(design)][i]);
  }
}

}  // namespace

std::vector<GuaranteeRow> table_of(const GuaranteeResult& result) {
  std::vector<GuaranteeRow> rows;
  for (std::size_t d = 0; d < kDesigns; ++d) {
    const auto design = static_cast<Design>(d);
    rows.push_back({design, "", "all", result.total(design)});
    add_rows(result, design, "direction", &Stratum::direction, rows);
    add_rows(result, design, "distance", &Stratum::distance, rows);
    add_rows(result, design, "aspect", &Stratum::aspect, rows);
    add_rows(result, design, "magnitude", &Stratum::magnitude, rows);
  }
  return rows;
}

std::string text_of(const std::vector<GuaranteeRow>& rows) {
  char line[200];
  std::snprintf(line, sizeof line, "%-13s %-10s %-13s %13s %12s %11s %10s %11s %11s\n", "design",
                "stratum", "", "tests", "exact hits", "lost", "found %", "redundant %", "escaped");
  std::string text = line;
  for (const GuaranteeRow& row : rows) {
    const Counts& c = row.counts;
    std::snprintf(line, sizeof line,
                  "%-13s %-10s %-13s %13llu %12llu %11llu %10.4f %11.3f %11llu\n",
                  name_of(row.design).c_str(), row.dimension.c_str(), row.kind.c_str(),
                  static_cast<unsigned long long>(c.tests), static_cast<unsigned long long>(c.hits),
                  static_cast<unsigned long long>(c.lost()), 100 * c.found(),
                  100 * c.redundant_share(), static_cast<unsigned long long>(c.escaped));
    text += line;
  }
  return text;
}

GuaranteeResult run_guarantee(std::uint64_t least_tests, unsigned threads, std::uint64_t seed) {
  std::vector<GuaranteeResult> results(threads);
  std::vector<std::thread> workers;
  for (unsigned i = 0; i < threads; ++i) {
    workers.emplace_back([&results, i, threads, least_tests, seed] {
      results[i] = run_worker((least_tests + threads - 1) / threads, seed + 1000003ULL * i);
    });
  }
  GuaranteeResult all;
  for (unsigned i = 0; i < threads; ++i) {
    workers[i].join();
    all.add(results[i]);
  }
  return all;
}

}  // namespace a2rt::hard
