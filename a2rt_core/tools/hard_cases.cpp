// hard-cases: the matrix of hard cases against units, leaks through closed surfaces, and what the
// failing units see.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "a2rt/base/text_file.h"
#include "a2rt/hard/hard_case.h"
#include "a2rt/hard/judge.h"
#include "a2rt/hard/views.h"
#include "a2rt/hard/watertight.h"
#include "a2rt/workload/file.h"
#include "command.h"
#include "progress.h"

namespace a2rt::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> cases, units, scenes;
  std::uint32_t origins = 20, rays = 1000, side = 161;
  std::string output;
};

std::vector<hard::UnitColumn> chosen_units(const Options& o) {
  if (o.units.empty()) {
    return hard::unit_columns();
  }
  std::vector<hard::UnitColumn> chosen;
  for (const std::string& key : o.units) {
    chosen.push_back(hard::unit_column(key));
  }
  return chosen;
}

std::vector<hard::HardCase> chosen_cases(const Options& o) {
  if (o.cases.empty()) {
    return hard::hard_cases();
  }
  std::vector<hard::HardCase> chosen;
  for (const std::string& key : o.cases) {
    chosen.push_back(hard::hard_case(key));
  }
  return chosen;
}

Json cell_json(const std::string& row, const hard::UnitColumn& column, const hard::Cell& cell) {
  Json json{{"case", row},
            {"unit", column.key},
            {"verdict", hard::name_of(cell.verdict())},
            {"rays", cell.rays},
            {"box_tests", cell.audit.box_tests},
            {"qbox_tests", cell.audit.qbox_tests},
            {"exact_hits", cell.audit.exact_hits + cell.audit.fp32_exact_hits},
            {"redundant", cell.redundant()},
            {"missed", cell.missed()},
            {"lost", cell.lost},
            {"rounding_ties", cell.rounding_ties},
            {"escapes", cell.audit.escapes},
            {"mechanisms", cell.audit.missed_by_mechanism},
            {"lost_by_mechanism", cell.lost_by_mechanism}};
  if (!cell.refusal.empty()) {
    json["refusal"] = cell.refusal;
  }
  return json;
}

// One line a case on standard output: E exact, c conservative, M misses, R refuses.
void print_row(const hard::HardCase& row, const std::vector<hard::Cell>& cells) {
  std::printf("%-20s", row.key.c_str());
  for (const hard::Cell& cell : cells) {
    const hard::Verdict v = cell.verdict();
    const std::string bad = v == hard::Verdict::kMisses ? " " + std::to_string(cell.missed()) +
                                                              "/" + std::to_string(cell.lost)
                                                        : "";
    std::printf(" %-14s", (hard::name_of(v) + bad).c_str());
  }
  std::printf("\n");
}

Json run_matrix(const Options& o, Progress& progress) {
  const auto cases = chosen_cases(o);
  const auto columns = chosen_units(o);
  Json json{{"units", Json::array()}, {"cases", Json::array()}, {"cells", Json::array()}};
  std::printf("%-20s", "case");
  for (const hard::UnitColumn& u : columns) {
    const UnitInfo info = hard::make_unit(u)->info();
    json["units"].push_back({{"key", u.key},
                             {"title", u.title},
                             {"unit", u.unit},
                             {"config", u.toml},
                             {"promises", info.promise != Promise::kMayMiss}});
    std::printf(" %-14s", u.key.c_str());
  }
  std::printf("\n");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const hard::HardCase& row = cases[i];
    json["cases"].push_back(
        {{"key", row.key}, {"group", row.group}, {"title", row.title}, {"what", row.what}});
    const Workload workload = row.make();
    const std::vector<Hit> truth = hard::true_hits(workload);
    std::vector<hard::Cell> cells;
    for (const hard::UnitColumn& u : columns) {
      cells.push_back(hard::judge(u, workload, truth));
      json["cells"].push_back(cell_json(row.key, u, cells.back()));
    }
    print_row(row, cells);
    progress.show(0.6 * static_cast<double>(i + 1) / static_cast<double>(cases.size()), row.title);
  }
  return json;
}

Json leaks_json(const std::string& mesh, const std::string& title, const std::string& unit,
                const hard::Leaks& leaks) {
  return {{"mesh", mesh},
          {"title", title},
          {"unit", unit},
          {"rays", leaks.rays},
          {"hits", leaks.hits},
          {"leaked", leaks.leaked},
          {"farther", leaks.farther},
          {"rounding_ties", leaks.rounding_ties},
          {"missed", leaks.missed}};
}

Json run_watertight(const Options& o, Progress& progress) {
  Json rows = Json::array();
  const auto columns = chosen_units(o);
  for (const hard::ClosedMesh& mesh : hard::closed_meshes()) {
    const Workload workload = mesh.make(o.origins);
    for (const hard::UnitColumn& u : columns) {
      rows.push_back(leaks_json(mesh.key, mesh.title, u.key, hard::count_leaks(u, workload)));
    }
    progress.show(0.75, mesh.title);
  }
  for (const std::string& file : o.scenes) {
    const std::string name = std::filesystem::path(file).stem().string();
    const Workload aimed = hard::aim_at_edges(read_workload(file), o.rays, 1);
    const std::vector<Hit> truth = hard::true_hits(aimed);
    for (const hard::UnitColumn& u : columns) {
      rows.push_back(leaks_json(name, "Scene " + name, u.key, hard::count_leaks(u, aimed, truth)));
    }
    progress.show(0.85, name);
  }
  for (const Json& row : rows) {
    std::printf(
        "watertight %-14s %-14s %9llu rays, %llu hits, %llu leaked, %llu farther, %llu "
        "boxes missed\n",
        row["mesh"].get<std::string>().c_str(), row["unit"].get<std::string>().c_str(),
        row["rays"].get<unsigned long long>(), row["hits"].get<unsigned long long>(),
        row["leaked"].get<unsigned long long>(), row["farther"].get<unsigned long long>(),
        row["missed"].get<unsigned long long>());
  }
  return rows;
}

// Pixels by rows: brightness as two hexadecimal digits each, and kind as one character each.
Json run_views(const Options& o, Progress& progress) {
  Json all = Json::array();
  for (const hard::View& view : hard::views()) {
    const hard::Picture picture = hard::draw(view, o.side);
    Json shade = Json::array(), kind = Json::array();
    for (std::size_t row = 0; row < picture.side; ++row) {
      std::string digits;
      for (std::size_t i = row * picture.side; i < (row + 1) * picture.side; ++i) {
        constexpr const char* kHex = "0123456789abcdef";
        digits += kHex[picture.shade[i] >> 4U];
        digits += kHex[picture.shade[i] & 15U];
      }
      shade.push_back(digits);
      kind.push_back(picture.kind.substr(row * picture.side, picture.side));
    }
    all.push_back({{"key", view.key},
                   {"unit", view.column},
                   {"title", view.title},
                   {"what", view.what},
                   {"side", picture.side},
                   {"hit_pixels", picture.hit_pixels},
                   {"lost", picture.lost},
                   {"farther", picture.farther},
                   {"mechanism", view.mechanism},
                   {"lost_by_mechanism", picture.lost_by_mechanism},
                   {"shade", shade},
                   {"kind", kind}});
    std::printf("view %-16s %llu of %llu pixels lost, %llu farther\n", view.key.c_str(),
                static_cast<unsigned long long>(picture.lost),
                static_cast<unsigned long long>(picture.hit_pixels),
                static_cast<unsigned long long>(picture.farther));
    progress.show(0.95, view.title);
  }
  return all;
}

int run(const Options& o) {
  Progress progress;
  Json json = run_matrix(o, progress);
  json["watertight"] = run_watertight(o, progress);
  json["views"] = run_views(o, progress);
  write_text_file(o.output, json.dump(1) + "\n");
  return 0;
}

const RegisterCommand kCommand(
    "hard-cases", "Judge every unit on hard cases: misses, leaks, and pictures of the failures",
    "  a2rt-core hard-cases -o matrix.json\n"
    "  a2rt-core hard-cases --cases axis_parallel,flat --units a2rt_wide,aqb8_floor -o m.json\n"
    "  a2rt-core hard-cases --scene cornell.h5 --scene forest.h5 -o matrix.json\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("--cases", options->cases, "Only these rows").delimiter(',');
      app.add("--units", options->units, "Only these columns").delimiter(',');
      app.add("--scene", options->scenes,
              "Workload file whose edges and vertices are aimed at as well")
          .check(cli::existing_file())
          .one_value_each();
      app.add("--origins", options->origins, "Ray origins inside each closed mesh")
          .check(cli::in_range(1, 100000));
      app.add("--rays", options->rays, "Rays per scene file").check(cli::in_range(1, 10000000));
      app.add("--side", options->side, "Pixels per side of the pictures")
          .check(cli::in_range(8, 2048));
      app.add("-o,--output", options->output, "JSON file to write").required();
      return [options] { return run(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
