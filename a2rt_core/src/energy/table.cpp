#include "a2rt/energy/table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

#include "a2rt/base/error.h"

namespace a2rt::energy {
namespace {

constexpr std::array<std::string_view, 13> kColumns = {
    "component",     "action",         "width",    "node_nm", "vdd",    "clock_ns", "energy_pj",
    "energy_low_pj", "energy_high_pj", "area_um2", "leak_uw", "source", "note"};

std::string at(const std::string& name, std::size_t line) {
  return name + ":" + std::to_string(line) + ": ";
}

// Fields of one line; a field in double quotes may hold commas.
std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

class LineReader {
 public:
  LineReader(const std::vector<std::string>& header, std::vector<std::string> fields,
             std::string place)
      : header_(header), fields_(std::move(fields)), place_(std::move(place)) {}
  const std::string& text(std::string_view column) const {
    for (std::size_t i = 0; i < header_.size(); ++i) {
      if (header_[i] == column) {
        if (fields_[i].empty()) {
          throw UserError(place_ + "column '" + std::string(column) + "' is empty");
        }
        return fields_[i];
      }
    }
    throw UserError(place_ + "no column '" + std::string(column) + "'");
  }
  double number(std::string_view column) const {
    const std::string& t = text(column);
    double value = 0;
    const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), value);
    if (error != std::errc() || end != t.data() + t.size() || !(value >= 0)) {
      throw UserError(place_ + "'" + t + "' in column '" + std::string(column) +
                      "' is not a number of at least 0");
    }
    return value;
  }

 private:
  const std::vector<std::string>& header_;
  std::vector<std::string> fields_;
  std::string place_;
};

Note note_of(const std::string& text, const std::string& place) {
  for (const Note note : {Note::kSynthesised, Note::kPublished, Note::kEstimated}) {
    if (text == note_name(note)) {
      return note;
    }
  }
  throw UserError(place + "note '" + text + "' is none of synthesised, published, estimated");
}

void check_header(const std::vector<std::string>& header, const std::string& place) {
  const std::set<std::string> seen(header.begin(), header.end());
  for (const std::string& column : header) {
    if (std::find(kColumns.begin(), kColumns.end(), column) == kColumns.end()) {
      throw UserError(place + "unknown column '" + column + "'");
    }
  }
  if (seen.size() != header.size()) {
    throw UserError(place + "a column is given twice");
  }
  for (const std::string_view column : kColumns) {
    if (!seen.contains(std::string(column))) {
      throw UserError(place + "column '" + std::string(column) + "' is missing");
    }
  }
}

Row read_row(const LineReader& line, const std::string& place) {
  Row row;
  row.component = line.text("component");
  row.action = line.text("action");
  row.width = static_cast<unsigned>(line.number("width"));
  row.node_nm = static_cast<unsigned>(line.number("node_nm"));
  row.vdd = line.number("vdd");
  row.clock_ns = line.number("clock_ns");
  row.energy_pj = line.number("energy_pj");
  row.energy_low_pj = line.number("energy_low_pj");
  row.energy_high_pj = line.number("energy_high_pj");
  row.area_um2 = line.number("area_um2");
  row.leak_uw = line.number("leak_uw");
  row.source = line.text("source");
  row.note = note_of(line.text("note"), place);
  if (row.energy_pj == 0) {
    throw UserError(place + row.component + "." + row.action +
                    " is free of charge; an action that costs nothing must not be emitted");
  }
  if (row.energy_low_pj > row.energy_pj || row.energy_high_pj < row.energy_pj) {
    throw UserError(place + row.component + "." + row.action + " lies outside its own band");
  }
  return row;
}

void check_against(const std::vector<Row>& rows, const Row& row, const std::string& place) {
  for (const Row& other : rows) {
    if (other.node_nm != row.node_nm) {
      throw UserError(place + "a row of " + std::to_string(row.node_nm) + " nm in a table of " +
                      std::to_string(other.node_nm) + " nm; one table holds one node");
    }
    if (other.component != row.component) {
      continue;
    }
    if (other.action == row.action) {
      throw UserError(place + row.component + "." + row.action + " is given twice");
    }
    if (row.area_um2 > 0 || row.leak_uw > 0) {
      throw UserError(place + "area and leakage of '" + row.component +
                      "' belong on its first row only, or they would count twice");
    }
  }
}

}  // namespace

const char* note_name(Note note) {
  switch (note) {
    case Note::kSynthesised:
      return "synthesised";
    case Note::kPublished:
      return "published";
    case Note::kEstimated:
      break;
  }
  return "estimated";
}

EnergyTable EnergyTable::from_file(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) {
    throw UserError("cannot read energy table " + file.string());
  }
  std::stringstream text;
  text << in.rdbuf();
  return from_text(text.str(), file.filename().string());
}

EnergyTable EnergyTable::from_text(std::string_view csv, const std::string& name) {
  EnergyTable table;
  table.name_ = name;
  std::istringstream in{std::string(csv)};
  std::vector<std::string> header;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line[0] == '#') {
      continue;
    }
    std::vector<std::string> fields = split(line);
    const std::string place = at(name, number);
    if (header.empty()) {
      check_header(fields, place);
      header = std::move(fields);
      continue;
    }
    if (fields.size() != header.size()) {
      throw UserError(place + std::to_string(fields.size()) + " fields under " +
                      std::to_string(header.size()) + " columns");
    }
    Row row = read_row(LineReader(header, std::move(fields), place), place);
    check_against(table.rows_, row, place);
    table.rows_.push_back(std::move(row));
  }
  if (table.rows_.empty()) {
    throw UserError(name + ": no rows");
  }
  return table;
}

const Row& EnergyTable::find(std::string_view component, std::string_view action) const {
  for (const Row& row : rows_) {
    if (row.component == component && row.action == action) {
      return row;
    }
  }
  throw UserError(name_ + ": no row for " + std::string(component) + "." + std::string(action));
}

const Row& EnergyTable::first_of(std::string_view component) const {
  for (const Row& row : rows_) {
    if (row.component == component) {
      return row;
    }
  }
  throw UserError(name_ + ": no row for component '" + std::string(component) + "'");
}

double EnergyTable::area_um2(std::string_view component) const {
  return first_of(component).area_um2;
}
double EnergyTable::leak_uw(std::string_view component) const {
  return first_of(component).leak_uw;
}

EnergyTable EnergyTable::scaled(std::string_view component, double factor,
                                const std::string& how) const {
  first_of(component);
  EnergyTable table = *this;
  for (Row& row : table.rows_) {
    if (row.component != component) {
      continue;
    }
    row.note = Note::kEstimated;
    row.source += "; " + how + ", times " + std::to_string(factor);
    for (double* value :
         {&row.energy_pj, &row.energy_low_pj, &row.energy_high_pj, &row.area_um2, &row.leak_uw}) {
      *value *= factor;
    }
  }
  return table;
}

}  // namespace a2rt::energy
