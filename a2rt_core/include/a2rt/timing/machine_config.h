// Parameters of the simulated GPU. Defaults are lumibench_configs/gpus/table1.toml: the paper's
// Table I, filled up from Vulkan-Sim's RTX2060 configuration. Every latency is in cycles of the
// domain named beside it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "a2rt/base/units.h"

namespace a2rt::config {
class Section;
}

namespace a2rt::timing {

// Testers: the fixed-function pipelines of an RT unit.
enum class Tester : std::uint8_t {
  kBox,         // FP32 ray-box
  kQBox,        // quantized ray-box
  kQuantizer,   // A2RT: ray into a group's grid
  kAnchor,      // AQB8: anchor test and cluster set-up (CLSTR)
  kUpdate,      // AQB8: closest t into the cluster's grid (UPDT)
  kTriangle,    // FP32 ray-triangle
  kTransform,   // ray into object space
  kSetup,       // reciprocal direction of a new ray (INIT)
  kDequantize,  // stored box back to FP32
  kCount
};
inline constexpr std::size_t kTesters = static_cast<std::size_t>(Tester::kCount);
const char* tester_name(Tester tester);

struct TesterConfig {
  std::uint32_t count = 1;  // over the whole GPU; 0 = none
  Cycles latency{1};        // RT clock
  Cycles interval{1};       // RT clock, between two starts on one tester
};

struct SmConfig {
  std::uint32_t count = 8;
  std::uint32_t warps = 32;
  std::uint32_t schedulers = 4;
  std::uint32_t independent_instructions = 2;  // issued back to back before one waits for another
  std::uint32_t loads_in_flight = 4;           // load instructions before their use
  Cycles alu_latency{4}, sfu_latency{21}, sfu_interval{8}, uniform_latency{8};
  std::uint32_t lsu_queue = 32;  // sectors waiting for the L1 port
  std::uint32_t lsu_sectors_per_cycle = 4;
  std::uint32_t words_per_load = 2;
};

// How addresses are made up for shader loads, of which the capture counts words only.
enum class ShaderMemory : std::uint8_t { kByPrimitive, kStreaming, kIdeal };

// How a read finds its way through the RT unit's port, the caches and DRAM.
enum class Model : std::uint8_t {
  kQueued,   // step by step, through queues with arbitration
  kReserved  // all of its way is reserved when it is asked for
};

struct L1Config {
  Bytes capacity{64 * 1024};
  std::uint32_t ways = 0;  // 0 = fully associative
  std::uint32_t banks = 4;
  Cycles latency{20};
  std::uint32_t mshrs = 256;   // sectors being fetched
  std::uint32_t merges = 256;  // requests waiting for one sector
};

struct L2Config {
  std::uint32_t channels = 12;
  std::uint32_t slices_per_channel = 2;
  Bytes slice_capacity{128 * 1024};
  std::uint32_t ways = 16;
  Cycles latency{160};  // core clock
  std::uint32_t mshrs = 192;
  std::uint64_t mhz = 1365;
  Bytes interleave{256};
  Cycles crossbar_latency{8};  // core clock, one way
};

// DRAM timings in cycles of the command clock.
struct DramConfig {
  std::uint64_t mhz = 3500;
  Cycles extra_latency{100};  // core clock, between L2 and the channel's queue
  std::uint32_t banks = 16;
  std::uint32_t queue = 64;
  Bytes row{2048};
  Cycles cl{20}, rcd{20}, rp{20}, ras{50}, rc{62}, ccd{4}, rrd{10}, wl{8}, burst{4}, rtp{4}, wr{20},
      turnaround{12};
};

enum class ContextPolicy : std::uint8_t { kStack, kRefetch };

struct RtConfig {
  std::uint64_t mhz = 1365;
  std::uint32_t warps = 4;
  std::uint32_t port_sectors = 1;   // sectors per cycle through the L1 port
  std::uint32_t stack_entries = 8;  // per ray, on chip; 0 = unlimited
  std::uint32_t stack_entry_bytes = 8;
  ContextPolicy context = ContextPolicy::kStack;
  std::uint32_t context_entries = 4;  // per ray, on chip; 0 = unlimited
  std::uint32_t context_bytes = 32;
  Cycles callback_latency{20};  // each way between RT unit and SM
  std::uint32_t callback_lanes =
      0;                     // candidates that trigger a round trip; 0 = when no lane can go on
  Cycles return_latency{4};  // last ray done until the warp can issue again
  std::array<TesterConfig, kTesters> testers{};

  TesterConfig& tester(Tester t) { return testers[static_cast<std::size_t>(t)]; }
  const TesterConfig& tester(Tester t) const { return testers[static_cast<std::size_t>(t)]; }
};

struct MachineConfig {
  std::string name = "table1";
  std::uint64_t core_mhz = 1365;
  Model model = Model::kQueued;
  SmConfig sm;
  ShaderMemory shader_memory = ShaderMemory::kByPrimitive;
  L1Config l1;
  L2Config l2;
  DramConfig dram;
  RtConfig rt;
  std::uint64_t watchdog_cycles = 200'000;

  MachineConfig();
  // Throws UserError (file:line:column) for a value out of range or a key that does not exist.
  static MachineConfig from_section(const config::Section& section);
};

}  // namespace a2rt::timing
