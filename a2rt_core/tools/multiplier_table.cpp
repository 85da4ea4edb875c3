// Error table of the approximate multiplier, exhausted over all operands.
#include <cstdio>
#include <string>
#include <vector>

#include "a2rt/arith/multiplier.h"
#include "command.h"

namespace a2rt::tools {
namespace {

struct TableOptions {
  std::vector<int> columns{0, 1, 2, 3, 4, 5, 6, 7, 8};
  int magnitude_bits = 10;
  int significand_bits = 8;
  std::string mode = "compress";
  bool csv = false;
};

void print_row(const TableOptions& options, int columns, const char* path, int carry,
               const arith::MultiplierError& raw, const arith::MultiplierError& rounded) {
  const char* format = options.csv ? "%d,%s,%d,%.6g,%.6g,%.6g,%.6g,%.6g\n"
                                   : "%3d  %-4s  %5d  %11.5g  %11.5g  %11.5g  %11.5g  %11.5g\n";
  std::printf(format, columns, path, carry, raw.worst, raw.mean, raw.worst_levels, rounded.worst,
              rounded.mean);
}

int print_table(const TableOptions& options) {
  std::printf(options.csv ? "k,path,carry,worst_relative,mean_relative,worst_levels,"
                            "worst_relative_rounded,mean_relative_rounded\n"
                          : "  k  path  carry   worst rel.    mean rel.  worst lvls.  "
                            "worst (rnd.)  mean (rnd.)\n");
  const arith::LowColumns mode = arith::low_columns_from(options.mode);
  for (const int k : options.columns) {
    const arith::ApproxMultiplier multiplier(options.magnitude_bits, options.significand_bits, k,
                                             mode);
    const auto carry = static_cast<int>(multiplier.carry_compensation());
    const arith::MultiplierErrors raw = arith::multiplier_errors(multiplier, options.magnitude_bits,
                                                                 options.significand_bits, false);
    const arith::MultiplierErrors rounded = arith::multiplier_errors(
        multiplier, options.magnitude_bits, options.significand_bits, true);
    print_row(options, k, "tmin", 0, raw.low, rounded.low);
    print_row(options, k, "tmax", carry, raw.high, rounded.high);
  }
  return 0;
}

const RegisterCommand kCommand(
    "multiplier-table", "Print the approximate multiplier's errors, exhausted over all operands",
    "  a2rt-core multiplier-table\n"
    "  a2rt-core multiplier-table --k 0 4 8 --magnitude-bits 8 --csv\n",
    [](cli::Options& app) {
      const auto options = std::make_shared<TableOptions>();
      app.add("--k", options->columns, "approximated columns, each 0 to 8")
          .check(cli::in_range(0, 8));
      app.add("--magnitude-bits", options->magnitude_bits, "bits of the integer operand")
          .check(cli::in_range(4, 14));
      app.add("--significand-bits", options->significand_bits,
              "bits of the significand, hidden bit included")
          .check(cli::in_range(5, 11));
      app.add("--mode", options->mode, "what happens to the low columns")
          .check(cli::one_of({"compress", "drop"}));
      app.flag("--csv", options->csv, "comma-separated values");
      return [options] { return print_table(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
