// A unit's hits against the driver's, ray by ray: where they differ, why?
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/workload/workload.h"

namespace a2rt {

// Why a unit's answer differs from the driver's. The first that holds, except that
// kDriverBoxLoss, which is certain, comes before kTminSelfHit.
enum class Match : std::uint8_t {
  kSame = 0,           // equal, or both hit and the ray asked for no particular hit
  kUnknown = 1,        // the driver's answer is not known
  kTie = 2,            // another primitive at the same distance, up to kTieTolerance
  kTminSelfHit = 3,    // the distance is within rounding of tmin
  kEdge = 4,           // the ray passes the primitive's edge within rounding
  kDriverBoxLoss = 5,  // the driver's triangle test accepts the unit's nearer hit, but its boxes,
                       // which are not padded, hid the triangle
  kLost = 6,  // the driver's hit, or one nearer than the unit's, is missing: the unit's loss
  kOther = 7  // none of these: a bug
};
inline constexpr std::size_t kMatchKinds = 8;
// Names for tables and JSON: same, unknown, tie, tmin_self_hit, edge, driver_box_loss, lost, other.
const char* match_name(Match match);

// Relative difference of two distances that counts as a tie.
inline constexpr double kTieTolerance = 2e-6;

// Category of one ray. `hit` is the unit's answer.
//
// An edge is decided in FP64 on the object-space ray and vertices: the smallest barycentric weight
// of the hit in question is at most 2^-16 of the largest. A unit with the driver's own triangle
// test never differs there, since both answer alike on edges.
Match compare_hit(const Workload& workload, std::size_t ray, const Hit& hit);

// Whether two answers mean the same to the program: for rays that end at their first hit, or skip
// the closest-hit shader, only hit or miss matters.
bool same_answer(const Ray& ray, const Hit& a, const Hit& b);

// Counts and examples over many rays. Reports of disjoint sets of rays can be merged.
struct MatchReport {
  struct Example {
    std::uint64_t ray = 0;
    Match match = Match::kSame;
    Hit driver, unit;
  };
  std::array<std::uint64_t, kMatchKinds> counts{};
  std::vector<Example> examples;  // of everything but kSame, at most `keep` per category
  std::size_t keep = 5;

  void add(const Workload& workload, std::size_t ray, const Hit& hit);
  void merge(const MatchReport& other);
  std::uint64_t count(Match match) const { return counts[static_cast<std::size_t>(match)]; }
};

}  // namespace a2rt
