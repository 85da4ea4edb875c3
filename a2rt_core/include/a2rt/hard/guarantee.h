// Runs every design's box test over stratified rays, groups and boxes, and counts what exact
// arithmetic says about each decision.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/hard/strata.h"

namespace a2rt::hard {

enum class Design : std::uint8_t {
  kWide,
  kGuard,
  kLiteral,
  kNearest,      // wide, but rounded to nearest everywhere
  kAqb8Floor,    // artifact's software rounding
  kAqb8Nearest,  // artifact's RTL rounding
  kPow2,         // cwbvh and clbvh: power-of-two grids, FP32 test of the dequantized box
  kCount
};
inline constexpr std::size_t kDesigns = static_cast<std::size_t>(Design::kCount);
std::string name_of(Design design);
bool claims_no_miss(Design design);

struct Counts {
  std::uint64_t tests = 0;      // tests by the design's own (quantized) tester
  std::uint64_t hits = 0;       // of these, exact hits
  std::uint64_t missed = 0;     // exact hit, design says no
  std::uint64_t redundant = 0;  // exact miss, design says hit
  std::uint64_t escaped = 0;    // decided by the accurate unit on dequantized boxes
  std::uint64_t escaped_missed = 0;
  std::uint64_t group_missed = 0;  // exact hits lost because the design's group test said no
  std::string first_missed;
  void add(const Counts& other);
  // Exact hits lost in any way: by the quantized test, after an escape, or with the group.
  std::uint64_t lost() const { return missed + escaped_missed + group_missed; }
  // Share of the exact hits of its own tests that the design finds.
  double found() const;
  // Share of the exact misses that it calls hits.
  double redundant_share() const;
};

struct GuaranteeResult {
  // By design and stratum (see stratum() for the numbering).
  std::array<std::vector<Counts>, kDesigns> counts;
  GuaranteeResult();
  Counts total(Design design) const;
  void add(const GuaranteeResult& other);
};

// One row of the table: a design over all strata of one kind.
struct GuaranteeRow {
  Design design{};
  std::string dimension;  // "direction", "distance", "aspect", "magnitude"; empty: all strata
  std::string kind;       // "near axis"
  Counts counts;
};
// All strata first, then the kinds of each dimension, for every design.
std::vector<GuaranteeRow> table_of(const GuaranteeResult& result);
// The table as text, a row a line.
std::string text_of(const std::vector<GuaranteeRow>& rows);

// `threads` workers, each with its own seed, until every claiming design has done at least
// `least_tests` quantized tests.
GuaranteeResult run_guarantee(std::uint64_t least_tests, unsigned threads, std::uint64_t seed);

}  // namespace a2rt::hard
