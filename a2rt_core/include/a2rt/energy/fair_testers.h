// Fair comparisons: how many testers each design gets.
//
// The yardstick is an A2RT engine of the paper's Table II: 120 quantized box testers, 15 accurate
// ones, 15 ray quantizers (24 triangle testers are common to all), at the area that its quantized
// testers have in the precision of the unit a2rt as configured.
// same count: a design gets as many box testers as A2RT has in all (FP32: 135 BOX), or one unit for
//   one (AQB8: 120 QBOX, 15 anchor and 15 update units; besides, one BOX per RT unit for the boxes
//   of procedural primitives, outside the comparison like the triangle testers).
// same area: FP32 gets as many BOX, AQB8 as many QBOX beside its 15 anchor and 15 update units, an
//   A2RT of another precision as many QBOX beside its 15 BOX and 15 quantizers, as fit the
//   yardstick's area.
#pragma once

#include <string>

#include "a2rt/energy/ledger.h"
#include "a2rt/energy/table.h"
#include "a2rt/timing/machine_config.h"

namespace a2rt::energy {

enum class Comparison { kConfig, kSameCount, kSameArea };
// "config", "same-count" or "same-area"; throws UserError otherwise.
Comparison comparison_of(const std::string& name);
const char* comparison_name(Comparison comparison);

struct TesterArea {
  double reference_um2 = 0;      // box testing part of the A2RT engine
  double used_um2 = 0;           // of this design's testers
  bool reached_minimum = false;  // fewer would fit than the machine has RT units
};

// Box testing part of Table II's engine at the table's areas.
double engine_area_um2(const EnergyTable& table);

// Sets the box-testing testers of `machine`; kConfig leaves them. `table` holds the design's own
// areas, `reference_um2` is the yardstick's.
TesterArea apply_comparison(Comparison comparison, Design design, double reference_um2,
                            const EnergyTable& table, timing::MachineConfig& machine);

}  // namespace a2rt::energy
