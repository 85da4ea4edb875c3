// Energy tables: one CSV per process node, one row per action, every row with its source.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace a2rt::energy {

enum class Note { kSynthesised, kPublished, kEstimated };
const char* note_name(Note note);

struct Row {
  std::string component, action;
  unsigned width = 0;  // bits per action
  unsigned node_nm = 0;
  double vdd = 0;        // V
  double clock_ns = 0;   // at which energy and area hold
  double energy_pj = 0;  // dynamic, per action
  double energy_low_pj = 0, energy_high_pj = 0;
  double area_um2 = 0;  // per instance; on a component's first row only
  double leak_uw = 0;   // per instance; likewise
  std::string source;
  Note note = Note::kEstimated;
};

// Rows in file order. All of one node; no two for the same component and action; no row without a
// source; no row whose energy is 0 or outside its own band.
class EnergyTable {
 public:
  // Throw UserError naming file and line for unknown, missing or doubled columns, unreadable
  // numbers, and any broken rule above.
  static EnergyTable from_file(const std::filesystem::path& file);
  static EnergyTable from_text(std::string_view csv, const std::string& name);

  const std::vector<Row>& rows() const { return rows_; }
  const std::string& name() const { return name_; }
  // Throws UserError naming the missing row.
  const Row& find(std::string_view component, std::string_view action) const;
  // Area and leakage of one instance. Throws UserError if the table has no such component.
  double area_um2(std::string_view component) const;
  double leak_uw(std::string_view component) const;
  // A copy with energy, area and leakage of `component` times `factor`; its rows become estimated
  // and their source says `how`. Throws UserError if the table has no such component.
  EnergyTable scaled(std::string_view component, double factor, const std::string& how) const;

 private:
  const Row& first_of(std::string_view component) const;
  std::vector<Row> rows_;
  std::string name_;
};

}  // namespace a2rt::energy
