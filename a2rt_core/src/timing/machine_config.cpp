#include "a2rt/timing/machine_config.h"

#include "a2rt/base/error.h"
#include "a2rt/config/section.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {
namespace {

constexpr std::int64_t kMany = 1'000'000;
constexpr std::int64_t kSlowestRt = 8;  // of the core's clock

// Typed readers: the struct's present value is the default.
class Reader {
 public:
  explicit Reader(config::Section section) : section_(std::move(section)) {}
  void operator()(std::uint32_t& v, const char* key, std::int64_t least, const char* unit,
                  const char* sentence) const {
    within(v, key, least, kMany, unit, sentence);
  }
  template <class Value>
  void within(Value& v, const char* key, std::int64_t least, std::int64_t most, const char* unit,
              const char* sentence) const {
    v = static_cast<Value>(
        section_.integer(key, static_cast<std::int64_t>(v), least, most, unit, sentence));
  }
  void operator()(std::uint64_t& v, const char* key, std::int64_t least, const char* unit,
                  const char* sentence) const {
    v = static_cast<std::uint64_t>(section_.integer(key, static_cast<std::int64_t>(v), least,
                                                    std::int64_t{1} << 40, unit, sentence));
  }
  template <class Tag>
  void operator()(Quantity<Tag>& v, const char* key, std::int64_t least, const char* unit,
                  const char* sentence) const {
    (*this)(v.value, key, least, unit, sentence);
  }
  const config::Section& section() const { return section_; }

 private:
  config::Section section_;
};

void read_sm(SmConfig& c, const Reader& r) {
  r(c.count, "count", 1, "SMs", "streaming multiprocessors, one RT unit each");
  r(c.warps, "warps", 1, "warps", "resident warps of 32 launch ids");
  r(c.schedulers, "schedulers", 1, "schedulers", "greedy-then-oldest, one issue per cycle each");
  r(c.independent_instructions, "independent_instructions", 1, "instructions",
    "issued back to back by a warp before it waits for the latency of the last");
  r(c.loads_in_flight, "loads_in_flight", 1, "instructions",
    "loads a warp issues before their use");
  r(c.alu_latency, "alu_latency", 1, "core cycles", "issue to use of an ALU result");
  r(c.sfu_latency, "sfu_latency", 1, "core cycles", "issue to use of an SFU result");
  r(c.sfu_interval, "sfu_interval", 1, "core cycles",
    "between two SFU instructions of a scheduler");
  r(c.uniform_latency, "uniform_latency", 1, "core cycles", "constant cache, which always hits");
  r(c.lsu_queue, "lsu_queue", 1, "sectors", "sectors that wait for the L1 before loads stall");
  r(c.lsu_sectors_per_cycle, "lsu_sectors_per_cycle", 1, "sectors", "load/store port to the L1");
  r(c.words_per_load, "words_per_load", 1, "32-bit words", "per lane of one load or store");
}

void read_l1(L1Config& c, const Reader& r) {
  r(c.capacity, "capacity", 128, "bytes", "L1 data cache of one SM, shared with its RT unit");
  r(c.ways, "ways", 0, "ways", "0 = fully associative; LRU");
  r(c.banks, "banks", 1, "banks", "interleaved by sector, one access per cycle each");
  r(c.latency, "latency", 1, "core cycles", "accepted to data, on a hit");
  r(c.mshrs, "mshrs", 1, "sectors", "sectors being fetched at a time");
  r(c.merges, "merges", 1, "requests", "requests that can wait for one sector");
}

void read_l2(L2Config& c, const Reader& r) {
  r(c.channels, "channels", 1, "channels", "memory channels");
  r(c.slices_per_channel, "slices_per_channel", 1, "slices", "L2 slices per memory channel");
  r(c.slice_capacity, "slice_capacity", 128, "bytes", "of one L2 slice");
  r(c.ways, "ways", 0, "ways", "0 = fully associative; LRU, write back");
  r(c.latency, "latency", 1, "core cycles", "lookup to data, on a hit");
  r(c.mshrs, "mshrs", 1, "sectors", "sectors being fetched at a time, per slice");
  r(c.mhz, "mhz", 1, "MHz", "L2 clock: one lookup per cycle and slice");
  r(c.interleave, "interleave", 128, "bytes", "consecutive bytes in one slice, whole lines");
  if (c.interleave.value % kLineBytes != 0) {
    throw UserError(r.section().where("interleave") + ": l2.interleave is " +
                    std::to_string(c.interleave.value) + ", must be a multiple of " +
                    std::to_string(kLineBytes) + " bytes, as a line lies in one slice");
  }
  r(c.crossbar_latency, "crossbar_latency", 1, "core cycles", "one way between SM and slice");
}

void read_dram(DramConfig& c, const Reader& r) {
  const char* unit = "command cycles";
  r(c.mhz, "mhz", 1, "MHz", "DRAM command clock");
  r(c.extra_latency, "extra_latency", 0, "core cycles", "from the L2 to the channel's queue");
  r(c.banks, "banks", 1, "banks", "per channel, one row buffer each");
  r(c.queue, "queue", 1, "requests", "FR-FCFS window per channel");
  r(c.row, "row", 128, "bytes", "row buffer of a bank");
  r(c.cl, "cl", 1, unit, "column read to first data");
  r(c.rcd, "rcd", 1, unit, "activate to column");
  r(c.rp, "rp", 1, unit, "precharge to activate");
  r(c.ras, "ras", 1, unit, "activate to precharge");
  r(c.rc, "rc", 1, unit, "activate to activate of one bank");
  r(c.ccd, "ccd", 1, unit, "column to column");
  r(c.rrd, "rrd", 1, unit, "activate to activate of different banks");
  r(c.wl, "wl", 1, unit, "column write to first data");
  r(c.burst, "burst", 1, unit, "data bus time of one 32-byte sector");
  r(c.rtp, "rtp", 1, unit, "read to precharge");
  r(c.wr, "wr", 1, unit, "end of write data to precharge");
  r(c.turnaround, "turnaround", 0, unit, "extra time when the data bus changes direction");
}

void read_testers(RtConfig& c, const config::Section& section) {
  for (std::size_t t = 0; t < kTesters; ++t) {
    const Reader r(section.table(tester_name(static_cast<Tester>(t))));
    r(c.testers[t].count, "count", 0, "testers", "over the whole GPU, spread evenly; 0 = none");
    r(c.testers[t].latency, "latency", 1, "RT cycles", "of one test");
    r(c.testers[t].interval, "interval", 1, "RT cycles", "between two tests of one tester");
  }
}

void read_rt(RtConfig& c, const Reader& r, std::uint64_t core_mhz) {
  // Time is counted in core cycles, and a port looks no further ahead than its bank calendar.
  const auto core = static_cast<std::int64_t>(core_mhz);
  r.within(c.mhz, "mhz", (core + kSlowestRt - 1) / kSlowestRt, core, "MHz",
           "RT unit clock: at most the core's, at least an eighth of it");
  r.within(c.warps, "warps", 1, 64, "warps", "places in the RT unit's warp buffer");
  r(c.port_sectors, "port_sectors", 1, "sectors", "through the RT unit's L1 port per RT cycle");
  r(c.stack_entries, "stack_entries", 0, "entries", "on-chip stack per ray; 0 = unlimited");
  r.within(c.stack_entry_bytes, "stack_entry_bytes", 1, kSectorBytes, "bytes",
           "of a stack entry when spilled; a sector holds at least one");
  r(c.context_entries, "context_entries", 0, "contexts",
    "group or cluster contexts kept on chip per ray; 0 = unlimited");
  r(c.context_bytes, "context_bytes", 1, "bytes", "of a context when spilled");
  r(c.callback_latency, "callback_latency", 0, "core cycles",
    "each way between RT unit and SM for any-hit and intersection shaders");
  r(c.callback_lanes, "callback_lanes", 0, "lanes",
    "candidates that start a round trip; 0 = when no ray of the warp can go on");
  r(c.return_latency, "return_latency", 0, "core cycles", "last ray done to the warp's next issue");
  c.context =
      r.section().choice("context", c.context == ContextPolicy::kStack ? "stack" : "refetch",
                         {"stack", "refetch"},
                         "how a ray returns to a group: from a context stack, or by fetching "
                         "and setting up again") == "stack"
          ? ContextPolicy::kStack
          : ContextPolicy::kRefetch;
  read_testers(c, r.section().table("testers"));
}

Model read_model(const config::Section& section) {
  return section.choice("model", "queued", {"queued", "reserved"},
                        "what is simulated between the RT units and DRAM: queues and their "
                        "arbitration, or ways reserved ahead, which is faster and less exact") ==
                 "queued"
             ? Model::kQueued
             : Model::kReserved;
}

ShaderMemory read_shader_memory(const config::Section& section) {
  const std::string name =
      section.choice("shader_memory", "primitive", {"primitive", "streaming", "ideal"},
                     "addresses of shader loads, of which captures count words only");
  return name == "primitive"   ? ShaderMemory::kByPrimitive
         : name == "streaming" ? ShaderMemory::kStreaming
                               : ShaderMemory::kIdeal;
}

}  // namespace

const char* tester_name(Tester tester) {
  static constexpr const char* kNames[] = {"box",       "qbox",   "quantizer",
                                           "anchor",    "update", "triangle",
                                           "transform", "setup",  "dequantize"};
  static_assert(std::size(kNames) == kTesters);
  return kNames[static_cast<std::size_t>(tester)];
}

MachineConfig::MachineConfig() {
  // Counts: paper, Table II (15 boxes, 120 quantized boxes, 15 quantizers, 24 triangles over 8
  // units). Latencies: stage counts of the public AQB8 RTL, interval 1 (fully pipelined); the
  // quantizer, transform and dequantizer are estimates from their operators on the same basis.
  rt.tester(Tester::kBox) = {15, Cycles{6}, Cycles{1}};
  rt.tester(Tester::kQBox) = {120, Cycles{2}, Cycles{1}};
  rt.tester(Tester::kQuantizer) = {15, Cycles{8}, Cycles{1}};
  rt.tester(Tester::kAnchor) = {15, Cycles{11}, Cycles{1}};
  rt.tester(Tester::kUpdate) = {15, Cycles{5}, Cycles{1}};
  rt.tester(Tester::kTriangle) = {24, Cycles{27}, Cycles{1}};
  rt.tester(Tester::kTransform) = {8, Cycles{8}, Cycles{1}};
  rt.tester(Tester::kSetup) = {8, Cycles{5}, Cycles{1}};
  rt.tester(Tester::kDequantize) = {120, Cycles{2}, Cycles{1}};
}

MachineConfig MachineConfig::from_section(const config::Section& section) {
  MachineConfig c;
  c.name = section.text("name", c.name, "name of the machine in reports");
  section.text("source", "", "where the values come from");
  const Reader top{section};
  top(c.core_mhz, "core_mhz", 1, "MHz", "core clock; SMs, L1, crossbar");
  top(c.watchdog_cycles, "watchdog_cycles", 1000, "core cycles",
      "without progress until the run is stopped with a dump");
  c.model = read_model(section);
  c.l2.mhz = c.rt.mhz = c.core_mhz;
  c.shader_memory = read_shader_memory(section);
  read_sm(c.sm, Reader(section.table("sm")));
  read_l1(c.l1, Reader(section.table("l1")));
  read_l2(c.l2, Reader(section.table("l2")));
  read_dram(c.dram, Reader(section.table("dram")));
  read_rt(c.rt, Reader(section.table("rt")), c.core_mhz);
  return c;
}

}  // namespace a2rt::timing
