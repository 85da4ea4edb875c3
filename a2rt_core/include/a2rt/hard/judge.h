// What an RT unit makes of a hard case: every box decision against exact arithmetic, every closest
// hit against brute force.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "a2rt/hard/hard_case.h"
#include "a2rt/rt/unit.h"

namespace a2rt::hard {

// A column of the matrix: a unit with the parameters that make it this design.
struct UnitColumn {
  std::string key;    // "a2rt_guard"
  std::string title;  // "A2RT, guard"
  std::string unit;   // registered name
  std::string toml;   // its parameters
};
const std::vector<UnitColumn>& unit_columns();
// Throws UserError naming the known keys.
const UnitColumn& unit_column(std::string_view key);
// The unit, not yet built.
std::unique_ptr<RtUnit> make_unit(const UnitColumn& column);

enum class Verdict : std::uint8_t {
  kExact,         // every decision as exact arithmetic
  kConservative,  // some boxes said to be hit that are not; none missed, no ray lost
  kMisses,        // boxes missed or rays lost
  kRefuses        // the encoder refuses the geometry with an error
};
std::string name_of(Verdict verdict);

struct Cell {
  std::uint64_t rays = 0;
  Audit audit;  // of all rays
  // Rays whose closest hit is not brute force's, and why: mechanisms of the missed boxes on that
  // ray. Sums to `lost`.
  std::uint64_t lost = 0;
  std::map<std::string, std::uint64_t> lost_by_mechanism;
  // Rays that differ only because FP32 rounding lets the triangle test accept a triangle whose box
  // the exact ray does not meet: no unit owes these, and they are not lost.
  std::uint64_t rounding_ties = 0;
  std::string refusal;  // the encoder's error

  std::uint64_t missed() const { return audit.missed_hits + audit.fp32_missed_hits; }
  std::uint64_t redundant() const { return audit.redundant_hits + audit.fp32_redundant_hits; }
  Verdict verdict() const;
};

// Does a unit that answered `found` owe brute force's hit `truth`? Not if the exact ray meets the
// box of that triangle nowhere up to `found`: then FP32 rounding in the triangle test made the hit.
bool owes(const Workload& workload, const Ray& ray, const Hit& truth, const Hit& found);

// The mechanism of most of the boxes that a ray which lost its hit missed.
std::string blame(const Audit& audit);

// Brute force's closest hit per ray; a miss for rays that are no numbers.
std::vector<Hit> true_hits(const Workload& workload);
// `truth`: true_hits(workload).
Cell judge(const UnitColumn& column, const Workload& workload, const std::vector<Hit>& truth);

}  // namespace a2rt::hard
