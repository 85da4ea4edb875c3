// Fair comparisons: how many testers each design gets.
//
// The yardstick is the A2RT engine of the paper's Table II: 120 quantized box testers, 15 accurate
// ones, 15 ray quantizers (24 triangle testers are common to all).
// same count: a design gets as many box testers as A2RT has in all (FP32: 135 BOX), or one unit for
//   one (AQB8: 120 QBOX, 15 anchor and 15 update units; besides, one BOX per RT unit for the boxes
//   of procedural primitives, outside the comparison like the triangle testers).
// same area: FP32 gets as many BOX, AQB8 as many QBOX beside its 15 anchor and 15 update units, as
//   fit the area of those 120 + 15 + 15, by the table's areas.
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

// Sets the box-testing testers of `machine`; kConfig leaves them. `unit_dequantizes` is true for
// compressed FP32 designs (cwbvh, clbvh), which carry a dequantizer per box tester.
TesterArea apply_comparison(Comparison comparison, Design design, bool unit_dequantizes,
                            const EnergyTable& table, timing::MachineConfig& machine);

}  // namespace a2rt::energy
