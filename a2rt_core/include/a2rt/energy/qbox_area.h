// Area and energy of one A2RT QBOX as its precision changes.
//
// The paper synthesised one precision (Table II). Others are estimated: the tester's datapath is
// counted in unit gates (Tyagi 1993: a two-input gate 1, an XOR or multiplexer bit 2 and 3, a half
// adder 3, a full adder 7) and the published area, power and leakage are scaled by the ratio of the
// counts. Activity per gate is taken as equal. Rows scaled so are marked estimated; RTL replaces
// them by editing the table.
#pragma once

#include "a2rt/arith/precision.h"
#include "a2rt/energy/table.h"

namespace a2rt::energy {

// Unit gates of one tester: two planes on each of three axes, then one comparison tree.
struct QBoxGates {
  double subtract = 0;   // plane - origin, its magnitude
  double multiply = 0;   // INT x FLOAT arrays, with their approximated columns
  double normalise = 0;  // product back to the direction format
  double compare = 0;    // maxima, minima and the final comparison
  double total() const { return subtract + multiply + normalise + compare; }
};
QBoxGates qbox_gates(const arith::A2rtPrecision& precision);

// The precision that Table II's QBOX is taken to have: the paper's 8-bit boxes and origins and BF16
// directions; of k, which it does not give, our default.
arith::A2rtPrecision published_precision();

// qbox_gates(precision) against those of the published one.
double qbox_scale(const arith::A2rtPrecision& precision);

// The table with its component qbox_a2rt scaled to `precision`.
EnergyTable for_precision(const EnergyTable& table, const arith::A2rtPrecision& precision);

}  // namespace a2rt::energy
