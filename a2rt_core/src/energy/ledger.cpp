#include "a2rt/energy/ledger.h"

#include <map>
#include <nlohmann/json.hpp>

#include "a2rt/base/error.h"

namespace a2rt::energy {
namespace {

constexpr double kPicojoulesPerMicrowattMillisecond = 1e3;

}  // namespace

double Ledger::dynamic_pj() const {
  double sum = 0;
  for (const Entry& e : entries) {
    sum += e.pj;
  }
  return sum;
}

double Ledger::leakage_pj() const {
  double sum = 0;
  for (const Leakage& l : leakage) {
    sum += l.pj;
  }
  return sum;
}

double Ledger::low_pj() const {
  double sum = leakage_pj();
  for (const Entry& e : entries) {
    sum += e.low_pj;
  }
  return sum;
}

double Ledger::high_pj() const {
  double sum = leakage_pj();
  for (const Entry& e : entries) {
    sum += e.high_pj;
  }
  return sum;
}

Ledger make_ledger(const std::vector<Action>& actions, const std::vector<Instances>& instances,
                   double milliseconds, const EnergyTable& table) {
  Ledger ledger;
  ledger.milliseconds = milliseconds;
  ledger.table = table.name();
  ledger.node_nm = table.rows().front().node_nm;
  for (const Action& a : actions) {
    const Row& row = table.find(a.component, a.action);
    const auto n = static_cast<double>(a.count);
    ledger.entries.push_back({a.component, a.action, row.source, row.note, a.count,
                              n * row.energy_pj, n * row.energy_low_pj, n * row.energy_high_pj});
  }
  for (const Instances& i : instances) {
    ledger.leakage.push_back({i.component, i.count,
                              static_cast<double>(i.count) * table.leak_uw(i.component) *
                                  milliseconds * kPicojoulesPerMicrowattMillisecond});
  }
  return ledger;
}

nlohmann::ordered_json ledger_json(const Ledger& ledger) {
  nlohmann::ordered_json actions = nlohmann::ordered_json::array();
  nlohmann::ordered_json by_component = nlohmann::ordered_json::object();
  nlohmann::ordered_json leakage = by_component, by_note = by_component;
  for (const Entry& e : ledger.entries) {
    actions.push_back({{"component", e.component},
                       {"action", e.action},
                       {"count", e.count},
                       {"pj", e.pj},
                       {"low_pj", e.low_pj},
                       {"high_pj", e.high_pj},
                       {"note", note_name(e.note)},
                       {"source", e.source}});
    by_component[e.component] = by_component.value(e.component, 0.0) + e.pj;
    by_note[note_name(e.note)] = by_note.value(note_name(e.note), 0.0) + e.pj;
  }
  for (const Leakage& l : ledger.leakage) {
    leakage[l.component] = l.pj;
    by_component[l.component] = by_component.value(l.component, 0.0) + l.pj;
  }
  return {{"total_pj", ledger.total_pj()},
          {"low_pj", ledger.low_pj()},
          {"high_pj", ledger.high_pj()},
          {"dynamic_pj", ledger.dynamic_pj()},
          {"leakage_pj", ledger.leakage_pj()},
          {"by_component", by_component},
          {"by_note", by_note},
          {"leakage", leakage},
          {"actions", actions},
          {"node_nm", ledger.node_nm},
          {"source", ledger.table}};
}

}  // namespace a2rt::energy
