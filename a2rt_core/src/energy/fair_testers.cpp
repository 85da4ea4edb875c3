#include "a2rt/energy/fair_testers.h"

#include <algorithm>
#include <cmath>

#include "a2rt/base/error.h"

namespace a2rt::energy {
namespace {

using timing::Tester;

// The A2RT engine, paper Table II.
constexpr std::uint32_t kQBoxes = 120, kBoxes = 15, kQuantizers = 15;
// AQB8 beside it: an anchor and an update unit for each accurate box tester of A2RT.
constexpr std::uint32_t kAnchors = 15, kUpdates = 15;

// The yardstick's own testers fit its area however the sums were rounded.
std::uint32_t fit(double area, double each) {
  constexpr double kRounding = 1e-9;
  return static_cast<std::uint32_t>(std::max(0.0, std::floor(area / each + kRounding)));
}

}  // namespace

Comparison comparison_of(const std::string& name) {
  for (const Comparison c : {Comparison::kConfig, Comparison::kSameCount, Comparison::kSameArea}) {
    if (name == comparison_name(c)) {
      return c;
    }
  }
  throw UserError("no comparison '" + name + "'; known: config, same-count, same-area");
}

const char* comparison_name(Comparison comparison) {
  switch (comparison) {
    case Comparison::kConfig:
      return "config";
    case Comparison::kSameCount:
      return "same-count";
    case Comparison::kSameArea:
      break;
  }
  return "same-area";
}

double engine_area_um2(const EnergyTable& table) {
  return kQBoxes * table.area_um2("qbox_a2rt") + kBoxes * table.area_um2("box") +
         kQuantizers * table.area_um2("quantizer");
}

namespace {

// Of the testers that belong to the design; a machine may hold others, which it does not use.
double used_um2(Design design, const EnergyTable& table, const timing::MachineConfig& machine) {
  const auto of = [&](Tester t, const char* component) {
    return machine.rt.tester(t).count * table.area_um2(component);
  };
  switch (design) {
    case Design::kFp32:
      return of(Tester::kBox, "box");
    case Design::kCompressed:
      return of(Tester::kBox, "box") + of(Tester::kDequantize, "dequantizer");
    case Design::kAqb8:
      return of(Tester::kQBox, "qbox_aqb8") + of(Tester::kAnchor, "anchor") +
             of(Tester::kUpdate, "update");
    case Design::kA2rt:
      break;
  }
  return of(Tester::kQBox, "qbox_a2rt") + of(Tester::kBox, "box") +
         of(Tester::kQuantizer, "quantizer");
}

}  // namespace

TesterArea apply_comparison(Comparison comparison, Design design, double reference_um2,
                            const EnergyTable& table, timing::MachineConfig& machine) {
  const double box = table.area_um2("box"), dequantizer = table.area_um2("dequantizer"),
               quantizer = table.area_um2("quantizer"), anchor = table.area_um2("anchor"),
               update = table.area_um2("update"), qbox_a2rt = table.area_um2("qbox_a2rt"),
               qbox_aqb8 = table.area_um2("qbox_aqb8");
  TesterArea area;
  area.reference_um2 = reference_um2;
  const bool dequantizes = design == Design::kCompressed;
  const auto count = [&](Tester t) -> std::uint32_t& { return machine.rt.tester(t).count; };
  const bool same_area = comparison == Comparison::kSameArea;
  if (comparison != Comparison::kConfig) {
    for (const Tester t : {Tester::kBox, Tester::kQBox, Tester::kQuantizer, Tester::kAnchor,
                           Tester::kUpdate, Tester::kDequantize}) {
      count(t) = 0;
    }
    const auto at_least_one_each = [&](std::uint32_t n) {
      area.reached_minimum = n < machine.sm.count;
      return std::max(n, machine.sm.count);
    };
    switch (design) {
      case Design::kFp32:
      case Design::kCompressed: {
        const double each = box + (dequantizes ? dequantizer : 0);
        const std::uint32_t n = same_area ? fit(area.reference_um2, each) : kQBoxes + kBoxes;
        count(Tester::kBox) = at_least_one_each(n);
        count(Tester::kDequantize) = dequantizes ? count(Tester::kBox) : 0;
        break;
      }
      case Design::kAqb8: {
        count(Tester::kAnchor) = kAnchors;
        count(Tester::kUpdate) = kUpdates;
        // For the FP32 boxes of procedural primitives only: common to all, like triangle testers.
        count(Tester::kBox) = machine.sm.count;
        const double rest = area.reference_um2 - kAnchors * anchor - kUpdates * update;
        count(Tester::kQBox) = at_least_one_each(same_area ? fit(rest, qbox_aqb8) : kQBoxes);
        break;
      }
      case Design::kA2rt: {
        const double rest = area.reference_um2 - kBoxes * box - kQuantizers * quantizer;
        count(Tester::kQBox) = at_least_one_each(same_area ? fit(rest, qbox_a2rt) : kQBoxes);
        count(Tester::kBox) = kBoxes;
        count(Tester::kQuantizer) = kQuantizers;
        // For the few pairs that leave the quantized range; not part of Table II's engine.
        count(Tester::kDequantize) = kBoxes;
        break;
      }
    }
  }
  area.used_um2 = used_um2(design, table, machine);
  return area;
}

}  // namespace a2rt::energy
