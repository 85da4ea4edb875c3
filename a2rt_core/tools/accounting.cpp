// accounting: what AQB8's public code charges a workload's rays, and what is left of its gain when
// both sides are counted alike.
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "a2rt/base/text_file.h"
#include "a2rt/config/section.h"
#include "a2rt/rt/functional.h"
#include "a2rt/rt/names.h"
#include "a2rt/rt/unit.h"
#include "a2rt/workload/file.h"
#include "command.h"

namespace a2rt::tools {
namespace {

struct Options {
  std::string workload, output;
};

struct Variant {
  const char* title;
  const char* unit;
  const char* toml;
};

constexpr Variant kVariants[] = {
    {"baseline as published", "baseline", "[layout]\naccounting = \"published\""},
    {"AQB8 as published", "aqb8", "artifact = true"},
    {"baseline, counted alike", "baseline", "[layout]\naccounting = \"corrected\""},
    {"AQB8, counted alike", "aqb8", "artifact = true\n[layout]\naccounting = \"corrected\""},
    {"baseline, our layout", "baseline", ""},
    {"AQB8, our layout", "aqb8", ""},
    {"A2RT, our layout", "a2rt", ""},
    {"A2RT, groups kept on pop", "a2rt", "[layout]\nrefetch_group = false"}};

struct Row {
  std::string title;
  std::uint64_t box_tests = 0, triangle_tests = 0;
  std::uint64_t frames = 0;  // anchors tested, or groups entered
  std::uint64_t reads = 0, nodes = 0, anchors = 0, triangles = 0, indices = 0, stores = 0;
  std::uint64_t node_bytes = 0, anchor_bytes = 0, triangle_bytes = 0;  // read
  std::uint64_t bytes() const { return node_bytes + anchor_bytes + triangle_bytes; }
};

Row measure(const Variant& variant, const Workload& workload) {
  const auto unit =
      unit_registry().create(variant.unit, config::Section::from_text(variant.toml, variant.title));
  unit->build(workload);
  const rt::EventTotals totals = rt::run_functional(*unit, workload).totals;
  const auto events = [&](EventKind k) { return totals.events[static_cast<std::size_t>(k)]; };
  const auto traffic = [&](Traffic k) { return totals.traffic[static_cast<std::size_t>(k)]; };
  Row row;
  row.title = variant.title;
  row.box_tests = events(EventKind::kBoxTest) + events(EventKind::kQBoxTest);
  row.triangle_tests = events(EventKind::kTriangleTest);
  row.frames = events(EventKind::kAnchorTest) + events(EventKind::kQuantizeRay);
  const auto both = [&](Traffic x, Traffic y, std::uint64_t& accesses, std::uint64_t& bytes) {
    accesses = traffic(x).accesses + traffic(y).accesses;
    bytes = traffic(x).bytes + traffic(y).bytes;
  };
  both(Traffic::kNode, Traffic::kSubNode, row.nodes, row.node_bytes);
  both(Traffic::kAnchor, Traffic::kGroupNode, row.anchors, row.anchor_bytes);
  row.triangles = traffic(Traffic::kTriangle).accesses;
  row.indices = traffic(Traffic::kPrimitiveIndex).accesses;
  row.triangle_bytes = traffic(Traffic::kTriangle).bytes + traffic(Traffic::kPrimitiveIndex).bytes;
  row.stores = traffic(Traffic::kResult).accesses;
  row.reads = row.nodes + row.anchors + row.triangles + row.indices;
  return row;
}

void print(const std::vector<Row>& rows) {
  std::printf("%-25s %11s %10s %10s %10s %10s %10s %10s %10s %10s %8s %8s %8s %8s\n", "variant",
              "box tests", "frames", "tri tests", "reads", "node", "anchor", "triangle", "index",
              "stores", "node MB", "anch MB", "tri MB", "all MB");
  for (const Row& r : rows) {
    const auto n = [](std::uint64_t v) { return static_cast<unsigned long long>(v); };
    const auto mb = [](std::uint64_t v) { return static_cast<double>(v) / 1e6; };
    std::printf(
        "%-25s %11llu %10llu %10llu %10llu %10llu %10llu %10llu %10llu %10llu %8.2f %8.2f %8.2f "
        "%8.2f\n",
        r.title.c_str(), n(r.box_tests), n(r.frames), n(r.triangle_tests), n(r.reads), n(r.nodes),
        n(r.anchors), n(r.triangles), n(r.indices), n(r.stores), mb(r.node_bytes),
        mb(r.anchor_bytes), mb(r.triangle_bytes), mb(r.bytes()));
  }
}

// Bytes that one variant reads as a share of another's.
double share(const std::vector<Row>& rows, std::size_t unit, std::size_t reference) {
  return static_cast<double>(rows[unit].bytes()) / static_cast<double>(rows[reference].bytes());
}

nlohmann::ordered_json to_json(const Row& r) {
  return {{"variant", r.title},
          {"box_tests", r.box_tests},
          {"triangle_tests", r.triangle_tests},
          {"reads", r.reads},
          {"node", r.nodes},
          {"anchor", r.anchors},
          {"triangle", r.triangles},
          {"primitive_index", r.indices},
          {"stores", r.stores},
          {"frames", r.frames},
          {"node_bytes", r.node_bytes},
          {"anchor_bytes", r.anchor_bytes},
          {"triangle_bytes", r.triangle_bytes}};
}

int account(const Options& options) {
  ReadOptions read;
  read.driver_nodes = false;
  const Workload workload = read_workload(options.workload, read);
  std::vector<Row> rows;
  for (const Variant& variant : kVariants) {
    rows.push_back(measure(variant, workload));
  }
  std::printf("%s: %zu rays; the first four rows in 64-byte lines, the others in records\n",
              options.workload.c_str(), workload.rays.size());
  print(rows);
  std::printf(
      "bytes read, of the baseline's: AQB8 %.1f %% as published, %.1f %% counted alike, %.1f %% in "
      "our layout; A2RT %.1f %%, %.1f %% if a popped group is not read again\n",
      100 * share(rows, 1, 0), 100 * share(rows, 3, 2), 100 * share(rows, 5, 4),
      100 * share(rows, 6, 4), 100 * share(rows, 7, 4));
  if (!options.output.empty()) {
    nlohmann::ordered_json json;
    json["workload"] = options.workload;
    json["rays"] = workload.rays.size();
    json["variants"] = nlohmann::ordered_json::array();
    for (const Row& row : rows) {
      json["variants"].push_back(to_json(row));
    }
    write_text_file(options.output, json.dump(2) + "\n");
  }
  return 0;
}

const RegisterCommand kCommand(
    "accounting", "Memory accesses as AQB8's public code counts them, and counted alike",
    "  a2rt-core accounting w.h5\n  a2rt-core accounting w.h5 -o accounting.json\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("workload", options->workload, "Workload file").required();
      app.add("-o,--output", options->output, "JSON file to write");
      return [options] { return account(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
