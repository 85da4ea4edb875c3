#include "a2rt/base/error.h"
#include "a2rt/config/section.h"
#include "a2rt/hard/judge.h"

namespace a2rt::hard {

const std::vector<UnitColumn>& unit_columns() {
  static const std::vector<UnitColumn> all{
      {"baseline", "FP32 baseline", "baseline", ""},
      {"a2rt_wide", "A²RT, wide", "a2rt", "[precision]\norigin = 'wide'\n"},
      {"a2rt_guard", "A²RT, guard", "a2rt", "[precision]\norigin = 'guard'\n"},
      {"a2rt_literal", "A²RT, literal", "a2rt-literal", ""},
      {"aqb8_floor", "AQB8, floor", "aqb8", "rounding = 'floor'\n"},
      {"aqb8_nearest", "AQB8, nearest", "aqb8", "rounding = 'nearest'\n"},
      {"cwbvh", "CWBVH", "cwbvh", ""},
      {"clbvh", "CLBVH", "clbvh", ""}};
  return all;
}

const UnitColumn& unit_column(std::string_view key) {
  std::string known;
  for (const UnitColumn& one : unit_columns()) {
    if (one.key == key) {
      return one;
    }
    known += known.empty() ? one.key : ", " + one.key;
  }
  throw UserError("no unit of the hard-case matrix is called " + std::string(key) +
                  "; known: " + known);
}

std::unique_ptr<RtUnit> make_unit(const UnitColumn& column) {
  const config::Section section =
      config::Section::from_text(column.toml, "hard-case unit " + column.key);
  std::unique_ptr<RtUnit> unit = unit_registry().create(column.unit, section);
  section.reject_unknown_keys();
  return unit;
}

}  // namespace a2rt::hard
