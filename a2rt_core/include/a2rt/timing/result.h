// What a timed run found out. Plain counts; rates and shares are formed where they are printed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "a2rt/timing/attribution.h"
#include "a2rt/timing/dram_channel.h"
#include "a2rt/timing/memory_port.h"
#include "a2rt/timing/rt_engine.h"
#include "a2rt/timing/sm.h"

namespace a2rt::timing {

struct TesterUse {
  std::uint32_t count = 0;  // over the GPU
  Cycles latency{1}, interval{1};
  std::uint64_t tests = 0;
  std::uint64_t busy_cycles = 0;    // RT clock, summed over testers
  std::uint64_t queued_cycles = 0;  // RT clock, summed over requests
};

struct DispatchTime {
  Cycles cycles;
  std::uint64_t rays = 0, warps = 0;
};

struct Series {
  std::string name, unit;
  std::uint64_t bin_cycles = 0;
  std::vector<double> means;
};

struct WarpRecord {
  std::uint32_t number = 0;  // in the run
  Cycles residence;
};

struct SimulationResult {
  Cycles cycles;
  double milliseconds = 0;
  std::vector<DispatchTime> dispatches;
  SmCounts sm;  // summed over SMs
  RtCounts rt;
  std::array<TesterUse, kTesters> testers{};
  CacheCounts l1, l2;
  TrafficCounts dram_reads{}, dram_writes{};
  DramCounts dram;
  std::uint64_t crossbar_sectors = 0;
  TrafficCounts l1_residence{};  // sector-cycles by kind
  std::array<std::uint64_t, static_cast<std::size_t>(SchedulerReason::kCount)> scheduler_reasons{};
  std::array<std::uint64_t, static_cast<std::size_t>(RtReason::kCount)> rt_reasons{};
  std::vector<Series> series;
  PowerHistogram ray_cycles;
  // Cycles of all rays of a launch id, dispatch after dispatch; width and height of the first.
  std::vector<std::uint32_t> launch_cycles;
  std::uint32_t width = 0, height = 0;
  std::vector<WarpRecord> warps;
  bool shader_counts_captured = false;
  std::uint64_t appointments = 0;
  double host_seconds = 0;

  std::uint64_t rays() const { return rt.rays; }
};

}  // namespace a2rt::timing
