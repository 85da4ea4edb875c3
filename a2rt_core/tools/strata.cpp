// strata: every design's box test over stratified rays, groups and boxes against exact arithmetic,
// and AQB8's loss near an axis.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "a2rt/base/text_file.h"
#include "a2rt/hard/guarantee.h"
#include "a2rt/hard/near_axis.h"
#include "command.h"

namespace a2rt::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::uint64_t tests = 10'000'000, seed = 1;
  std::uint32_t rays = 20'000;
  unsigned threads = 0;
  std::string output;
};

Json row_json(const hard::GuaranteeRow& row) {
  const hard::Counts& c = row.counts;
  Json json{{"design", hard::name_of(row.design)},
            {"promises", hard::claims_no_miss(row.design)},
            {"dimension", row.dimension},
            {"kind", row.kind},
            {"tests", c.tests},
            {"exact_hits", c.hits},
            {"missed", c.missed},
            {"group_missed", c.group_missed},
            {"escaped", c.escaped},
            {"escaped_missed", c.escaped_missed},
            {"redundant", c.redundant},
            {"found_share", c.found()},
            {"redundant_share", c.redundant_share()}};
  if (row.dimension.empty() && !c.first_missed.empty()) {
    json["first_missed"] = c.first_missed;
  }
  return json;
}

Json near_axis(const Options& o) {
  Json rows = Json::array();
  std::printf("\nAQB8 near an axis: rays aimed into a box that it misses, %%\n");
  for (const hard::NearAxisRow& row : hard::aqb8_near_axis_table()) {
    const auto floor =
        hard::aqb8_near_axis_loss(row.exponent, arith::Aqb8Rounding::kFloorCeil, o.rays);
    const auto nearest =
        hard::aqb8_near_axis_loss(row.exponent, arith::Aqb8Rounding::kNearestEven, o.rays);
    rows.push_back({{"exponent", row.exponent},
                    {"rays", floor.hits},
                    {"study_percent", row.percent},
                    {"floor_percent", floor.percent()},
                    {"nearest_percent", nearest.percent()}});
    std::printf("  |d| in 2^%d .. 2^%d: %5.1f floor, %5.1f nearest (study of the artifact: %.0f)\n",
                row.exponent, row.exponent + 1, floor.percent(), nearest.percent(), row.percent);
  }
  return rows;
}

int run(const Options& o) {
  const unsigned threads =
      o.threads != 0 ? o.threads : std::max(1U, std::thread::hardware_concurrency());
  const auto rows = hard::table_of(hard::run_guarantee(o.tests, threads, o.seed));
  std::printf("%s", hard::text_of(rows).c_str());
  Json json{{"least_tests", o.tests}, {"seed", o.seed}, {"strata", hard::kStrata}};
  json["rows"] = Json::array();
  for (const hard::GuaranteeRow& row : rows) {
    json["rows"].push_back(row_json(row));
  }
  json["near_axis"] = near_axis(o);
  if (!o.output.empty()) {
    write_text_file(o.output, json.dump(1) + "\n");
  }
  return 0;
}

const RegisterCommand kCommand(
    "strata", "Box tests of every design over stratified inputs, against exact arithmetic",
    "  a2rt-core strata\n"
    "  a2rt-core strata --tests 1000000000 -o strata.json\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("--tests", options->tests, "At least so many quantized tests per design");
      app.add("--near-axis-rays", options->rays, "Rays per row of AQB8's near-axis table")
          .check(cli::in_range(100, 10000000));
      app.add("--seed", options->seed, "Seed of the inputs");
      app.add("--threads", options->threads, "Threads (all)");
      app.add("-o,--output", options->output, "JSON file to write");
      return [options] { return run(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
