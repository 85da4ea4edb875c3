#include "simulate_print.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "a2rt/timing/result_json.h"

namespace a2rt::tools {
namespace {

using timing::SimulationResult;

double percent(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

template <class Reason, class Array>
void print_reasons(const char* title, const Array& cycles) {
  double whole = 0;
  for (const std::uint64_t c : cycles) {
    whole += static_cast<double>(c);
  }
  std::printf("  %-18s", title);
  for (std::size_t r = 0; r < cycles.size(); ++r) {
    const double share = percent(static_cast<double>(cycles[r]), whole);
    if (share >= 0.05) {
      std::printf(" %s %.1f%%", timing::reason_name(static_cast<Reason>(r)), share);
    }
  }
  std::printf("\n");
}

void print_testers(const SimulationResult& r, const timing::MachineConfig& machine) {
  std::printf("  %-18s", "testers");
  const double cycles = static_cast<double>(r.cycles.value) * static_cast<double>(machine.rt.mhz) /
                        static_cast<double>(machine.core_mhz);
  for (std::size_t t = 0; t < timing::kTesters; ++t) {
    const timing::TesterUse& use = r.testers[t];
    if (use.tests > 0) {
      std::printf(" %s %ux %.1f%%", timing::tester_name(static_cast<timing::Tester>(t)), use.count,
                  percent(static_cast<double>(use.busy_cycles), cycles * use.count));
    }
  }
  std::printf("\n");
}

void print_memory(const SimulationResult& r) {
  std::printf("  %-18s %12s %7s %12s %12s\n", "sectors of 32 B", "L1", "hits", "L2", "DRAM");
  for (std::size_t k = 1; k < timing::kTrafficKinds; ++k) {
    const std::uint64_t l1 = r.l1.reads[k] + r.l1.writes[k];
    if (l1 == 0) {
      continue;
    }
    std::printf("  %-18s %12llu %6.1f%% %12llu %12llu\n",
                timing::traffic_name(static_cast<Traffic>(k)), static_cast<unsigned long long>(l1),
                percent(static_cast<double>(r.l1.hits[k]), static_cast<double>(r.l1.reads[k])),
                static_cast<unsigned long long>(r.l2.reads[k] + r.l2.writes[k]),
                static_cast<unsigned long long>(r.dram_reads[k] + r.dram_writes[k]));
  }
}

}  // namespace

void print_simulation(const std::string& title, const SimulationResult& r,
                      const timing::MachineConfig& machine, const energy::Ledger& ledger,
                      const std::optional<timing::Estimate>& estimate) {
  std::printf("%s on %s\n", title.c_str(), machine.name.c_str());
  std::printf(
      "  %llu cycles = %.4f ms, %llu rays, %.1f Mray/s on the machine; simulated in %.2f s "
      "= %.0f rays/s\n",
      static_cast<unsigned long long>(r.cycles.value), r.milliseconds,
      static_cast<unsigned long long>(r.rays()),
      static_cast<double>(r.rays()) / (r.milliseconds * 1e3), r.host_seconds,
      static_cast<double>(r.rays()) / r.host_seconds);
  if (estimate) {
    std::printf("  estimate for all warps: %.0f cycles, 95 %% interval %.0f to %.0f\n",
                estimate->value, estimate->low, estimate->high);
  }
  print_reasons<timing::SchedulerReason>("schedulers", r.scheduler_reasons);
  print_reasons<timing::RtReason>("RT units", r.rt_reasons);
  print_reasons<timing::LaneReason>("rays in RT units", r.rt.lane_cycles);
  print_testers(r, machine);
  print_memory(r);
  std::printf("  energy %.3f mJ (%.3f to %.3f), leakage %.1f%% of it\n", ledger.total_pj() * 1e-9,
              ledger.low_pj() * 1e-9, ledger.high_pj() * 1e-9,
              percent(ledger.leakage_pj(), ledger.total_pj()));
}

}  // namespace a2rt::tools
