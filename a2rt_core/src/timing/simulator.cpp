#include "a2rt/timing/simulator.h"

#include <algorithm>
#include <ctime>

#include "a2rt/timing/memory.h"

namespace a2rt::timing {
namespace {

class Machine final : public SmHost {
 public:
  Machine(const Workload& workload, RaySource& source, const MachineConfig& config, Cycles stretch)
      : workload_(workload),
        config_(config),
        stretch_(stretch > Cycles{0} ? std::min(stretch, Memory::stretch(config))
                                     : Memory::stretch(config)),
        addresses_(workload, config),
        memory_(make_memory(config, slice_calendar_, dram_calendar_)) {
    for (std::uint32_t i = 0; i < config.sm.count; ++i) {
      calendars_.push_back(std::make_unique<Calendar>());
      sms_.push_back(
          std::make_unique<Sm>(config, i, *calendars_.back(), *memory_, source, addresses_, *this));
      memory_->connect(i, sms_.back()->l1(), *calendars_.back());
    }
  }

  SimulationResult run(const std::vector<WarpPlace>& places,
                       const std::vector<std::uint32_t>& chosen,
                       const std::function<void(double)>& progress);

 private:
  void run_dispatch();
  void run(Calendar& calendar, Cycles end);
  void run_sm(std::size_t index, Cycles end);
  void run_sms(Cycles end);
  bool next_cycle(Cycles& next) const;
  Cycles last_progress() const;
  void check_progress() const;
  std::string dump() const;
  void collect();
  void collect_sm(Sm& sm);
  bool next_warp(NewWarp& warp) override;
  void warp_retired(std::uint32_t sm, std::uint32_t number, Cycles residence) override;
  void ray_time(std::uint32_t launch, Cycles cycles) override;

  const Workload& workload_;
  MachineConfig config_;
  Cycles stretch_;
  // One calendar per SM and two for the memory below: what goes from one to another takes at least
  // Memory::stretch(), so each runs that far alone while its state is in the host's caches.
  std::vector<std::unique_ptr<Calendar>> calendars_;
  Calendar dram_calendar_, slice_calendar_;
  Cycles now_;  // start of the stretch that runs
  Cycles end_;  // last cycle in which anything happened
  ShaderAddresses addresses_;
  std::unique_ptr<Memory> memory_;
  std::vector<std::unique_ptr<Sm>> sms_;
  std::unique_ptr<DispatchProgram> program_;
  const std::vector<WarpPlace>* places_ = nullptr;
  std::vector<std::uint32_t> queue_;  // warp numbers of the current dispatch
  std::size_t queue_next_ = 0;
  std::uint64_t retired_ = 0, total_ = 0;
  std::vector<std::uint64_t> launch_base_;  // of each dispatch, in launch_cycles
  std::uint64_t dispatch_base_ = 0;         // of the present one
  SimulationResult result_;
};

bool Machine::next_warp(NewWarp& warp) {
  if (queue_next_ == queue_.size()) {
    return false;
  }
  const std::uint32_t number = queue_[queue_next_++];
  const WarpPlace& place = (*places_)[number];
  warp.program = WarpProgram(workload_, *program_, place.first_launch, place.count);
  warp.number = number;
  warp.width = workload_.dispatches[place.dispatch].width;
  return true;
}

void Machine::warp_retired(std::uint32_t, std::uint32_t number, Cycles residence) {
  ++retired_;
  result_.warps.push_back({number, residence});
}

void Machine::ray_time(std::uint32_t launch, Cycles cycles) {
  result_.ray_cycles.add(cycles.value);
  result_.launch_cycles[dispatch_base_ + launch] += static_cast<std::uint32_t>(cycles.value);
}

Cycles Machine::last_progress() const {
  Cycles last = std::max(dram_calendar_.last_progress(), slice_calendar_.last_progress());
  for (const auto& calendar : calendars_) {
    last = std::max(last, calendar->last_progress());
  }
  return last;
}

// A cycle before which nothing happens; false if nothing will. Appointments far away are come to in
// steps of the calendar's wheel.
bool Machine::next_cycle(Cycles& next) const {
  bool any = false;
  const auto look = [&](const Calendar& calendar) {
    if (!calendar.empty()) {
      next = any ? std::min(next, calendar.next()) : calendar.next();
      any = true;
    }
  };
  for (const auto& sm : sms_) {
    if (sm->turn() != Sm::kNoTurn) {
      next = any ? std::min(next, sm->turn()) : sm->turn();
      any = true;
    }
  }
  look(dram_calendar_);
  look(slice_calendar_);
  for (const auto& calendar : calendars_) {
    look(*calendar);
  }
  return any;
}

std::string Machine::dump() const {
  std::string text = "cycle " + std::to_string(now_.value) + ", last progress in cycle " +
                     std::to_string(last_progress().value) + ", " + std::to_string(retired_) + "/" +
                     std::to_string(total_) + " warps done\n";
  for (const auto& sm : sms_) {
    text += sm->dump();
  }
  return text + memory_->dump();
}

void Machine::check_progress() const {
  const Cycles last = last_progress();
  const std::uint64_t idle = now_ > last ? now_.value - last.value : 0;
  A2RT_CHECK(idle <= config_.watchdog_cycles, "no progress for " + std::to_string(idle) +
                                                  " cycles; state of the machine:\n" + dump());
}

void Machine::run(Calendar& calendar, Cycles end) {
  calendar.run_before([end] { return end; });
  end_ = std::max(end_, calendar.now());
}

void Machine::run_sm(std::size_t index, Cycles end) {
  const Sm& sm = *sms_[index];
  calendars_[index]->run_before([&] { return std::min(end, sm.turn()); });
  end_ = std::max(end_, calendars_[index]->now());
}

// Every SM runs to the end of the stretch, or to where it takes a warp. Warps go to the SMs in the
// order in which they ask, so the one that asks first goes on first.
void Machine::run_sms(Cycles end) {
  for (std::size_t i = 0; i < sms_.size(); ++i) {
    sms_[i]->rt().begin_stretch(now_);
    run_sm(i, end);
  }
  while (true) {
    const auto first = std::min_element(sms_.begin(), sms_.end(), [](const auto& a, const auto& b) {
      return a->turn() < b->turn();
    });
    const Cycles at = (*first)->turn();
    if (at >= end) {
      return;
    }
    const auto index = static_cast<std::size_t>(first - sms_.begin());
    calendars_[index]->move_to(at);
    (*first)->take_turn(at);
    run_sm(index, end);
  }
}

void Machine::run_dispatch() {
  const Cycles start = end_;
  now_ = start;
  const std::uint64_t rays_before = result_.ray_cycles.count();
  bool launched = true;
  while (launched) {
    launched = false;
    for (const auto& sm : sms_) {
      launched |= sm->launch(start);
    }
  }
  while (next_cycle(now_)) {
    check_progress();
    memory_->begin_stretch(now_);
    const Cycles end = now_ + stretch_;
    run(dram_calendar_, end);
    run_sms(end);
    memory_->sms_done();
    run(slice_calendar_, end);
  }
  A2RT_CHECK(queue_next_ == queue_.size() &&
                 std::all_of(sms_.begin(), sms_.end(), [](const auto& sm) { return sm->idle(); }),
             "nothing is left to happen, yet warps are not done; state of the machine:\n" + dump());
  result_.dispatches.push_back(
      {end_ - start, result_.ray_cycles.count() - rays_before, queue_.size()});
}

SimulationResult Machine::run(const std::vector<WarpPlace>& places,
                              const std::vector<std::uint32_t>& chosen,
                              const std::function<void(double)>& progress) {
  places_ = &places;
  total_ = chosen.size();
  std::uint64_t launches = 0;
  for (const Dispatch& d : workload_.dispatches) {
    launch_base_.push_back(launches);
    launches += std::uint64_t{d.width} * d.height * d.depth;
  }
  result_.launch_cycles.assign(launches, 0);
  if (!workload_.dispatches.empty()) {
    result_.width = workload_.dispatches.front().width;
    result_.height = workload_.dispatches.front().height;
  }
  std::size_t i = 0;
  while (i < chosen.size()) {
    const std::uint32_t dispatch = places[chosen[i]].dispatch;
    queue_.clear();
    queue_next_ = 0;
    for (; i < chosen.size() && places[chosen[i]].dispatch == dispatch; ++i) {
      queue_.push_back(chosen[i]);
    }
    program_ = std::make_unique<DispatchProgram>(workload_, dispatch);
    dispatch_base_ = launch_base_[dispatch];
    result_.shader_counts_captured |= program_->from_capture();
    run_dispatch();
    if (progress) {
      progress(static_cast<double>(i) / static_cast<double>(chosen.size()));
    }
  }
  collect();
  return std::move(result_);
}

namespace {

template <class Array>
void add_all(Array& to, const Array& from) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i] += from[i];
  }
}

void add_sm(SmCounts& to, const SmCounts& from) {
  to.warps += from.warps;
  to.alu += from.alu;
  to.sfu += from.sfu;
  to.uniform += from.uniform;
  to.loads += from.loads;
  to.stores += from.stores;
  to.traces += from.traces;
  add_all(to.lane_operations, from.lane_operations);
  to.lsu_sectors += from.lsu_sectors;
  to.warp_cycles += from.warp_cycles;
  to.rt_warp_cycles += from.rt_warp_cycles;
}

void add_rt(RtCounts& to, const RtCounts& from) {
  add_all(to.events, from.events);
  add_all(to.fetches, from.fetches);
  add_all(to.fetch_bytes, from.fetch_bytes);
  add_all(to.sectors_wanted, from.sectors_wanted);
  add_all(to.lane_cycles, from.lane_cycles);
  to.rays += from.rays;
  to.warps += from.warps;
  to.sectors_sent += from.sectors_sent;
  to.stores_sent += from.stores_sent;
  to.port_cycles += from.port_cycles;
  to.stack_spills += from.stack_spills;
  to.stack_fills += from.stack_fills;
  to.context_spills += from.context_spills;
  to.context_fills += from.context_fills;
  to.context_refetches += from.context_refetches;
  to.context_refetch_steps += from.context_refetch_steps;
  to.context_saves += from.context_saves;
  to.context_restores += from.context_restores;
  to.stack_pushed += from.stack_pushed;
  to.stack_popped += from.stack_popped;
  to.stack_spilled += from.stack_spilled;
  to.stack_filled += from.stack_filled;
  to.round_trips += from.round_trips;
  to.candidates += from.candidates;
  to.warp_cycles += from.warp_cycles;
}

void add_cache(CacheCounts& to, const CacheCounts& from) {
  add_all(to.reads, from.reads);
  add_all(to.hits, from.hits);
  add_all(to.merges, from.merges);
  add_all(to.misses, from.misses);
  add_all(to.writes, from.writes);
  to.bank_conflicts += from.bank_conflicts;
  to.mshr_full += from.mshr_full;
  to.fills += from.fills;
  to.evictions += from.evictions;
  to.written_back += from.written_back;
}

std::uint64_t total(const TrafficCounts& counts) {
  std::uint64_t sum = 0;
  for (const std::uint64_t c : counts) {
    sum += c;
  }
  return sum;
}

// Sums one series over the SMs; all have run for the same time, so their bins agree or are doubled.
void add_series(std::vector<Series>& all, const char* name, const char* unit,
                const BinnedSeries& from, Cycles end) {
  const std::vector<double> means = from.means(end);
  for (Series& s : all) {
    if (s.name == name && s.bin_cycles == from.width()) {
      s.means.resize(std::max(s.means.size(), means.size()));
      for (std::size_t i = 0; i < means.size(); ++i) {
        s.means[i] += means[i];
      }
      return;
    }
  }
  all.push_back({name, unit, from.width(), means});
}

}  // namespace

void Machine::collect_sm(Sm& sm) {
  sm.finish(result_.cycles);
  sm.check_drained();
  add_sm(result_.sm, sm.counts());
  add_rt(result_.rt, sm.rt().counts());
  add_cache(result_.l1, sm.l1().counts());
  add_all(result_.l1_residence, sm.l1().tags().residence(result_.cycles));
  add_all(result_.scheduler_reasons, sm.reasons());
  add_all(result_.rt_reasons, sm.rt().attribution().cycles());
  for (std::size_t t = 0; t < kTesters; ++t) {
    const TesterPool& pool = sm.rt().pool(static_cast<Tester>(t));
    result_.testers[t].count += pool.count();
    result_.testers[t].tests += pool.tests();
    result_.testers[t].busy_cycles += pool.busy_cycles();
    result_.testers[t].queued_cycles += pool.queued_cycles();
  }
  add_series(result_.series, "sm_warps", "warps", sm.occupancy(), result_.cycles);
  add_series(result_.series, "rt_warps", "warps", sm.rt().occupancy(), result_.cycles);
  add_series(result_.series, "rt_rays", "rays", sm.rt().active_lanes(), result_.cycles);
  add_series(result_.series, "rt_ports", "L1 ports in use", sm.rt().port_use(), result_.cycles);
}

void Machine::collect() {
  result_.cycles = end_;
  for (const auto& sm : sms_) {
    // Issue and port bookings may reach one cycle beyond the last appointment.
    result_.cycles = std::max(result_.cycles, sm->booked_until());
  }
  for (std::size_t t = 0; t < kTesters; ++t) {
    result_.testers[t].latency = config_.rt.testers[t].latency;
    result_.testers[t].interval = config_.rt.testers[t].interval;
  }
  for (const auto& sm : sms_) {
    collect_sm(*sm);
  }
  memory_->check_drained();
  const MemoryCounts below = memory_->counts();
  result_.l2 = below.l2;
  result_.dram = below.dram;
  result_.dram_reads = below.dram_reads;
  result_.dram_writes = below.dram_writes;
  result_.crossbar_sectors = below.crossbar_sectors;
  result_.milliseconds =
      static_cast<double>(result_.cycles.value) / (static_cast<double>(config_.core_mhz) * 1e3);
  result_.appointments = dram_calendar_.made() + slice_calendar_.made();
  for (const auto& calendar : calendars_) {
    result_.appointments += calendar->made();
  }
  A2RT_CHECK(total(result_.l1.misses) == total(result_.l2.reads), "L1 misses differ from L2 reads");
  A2RT_CHECK(result_.rt.rays == result_.ray_cycles.count(), "a ray was lost in an RT unit");
  A2RT_CHECK(retired_ == total_, "a warp was lost");
  std::sort(result_.warps.begin(), result_.warps.end(),
            [](const WarpRecord& a, const WarpRecord& b) { return a.number < b.number; });
}

}  // namespace

std::vector<WarpPlace> list_warps(const Workload& workload,
                                  const std::vector<std::uint32_t>& frames) {
  std::vector<WarpPlace> warps;
  for (std::uint32_t d = 0; d < workload.dispatches.size(); ++d) {
    const Dispatch& dispatch = workload.dispatches[d];
    if (!frames.empty() &&
        std::find(frames.begin(), frames.end(), dispatch.frame) == frames.end()) {
      continue;
    }
    for (std::uint32_t row = 0; row < dispatch.height * dispatch.depth; ++row) {
      for (std::uint32_t x = 0; x < dispatch.width; x += kLanes) {
        warps.push_back({d, row * dispatch.width + x, std::min(kLanes, dispatch.width - x)});
      }
    }
  }
  return warps;
}

namespace {

// Processor time of this thread: what else runs on the host is not the model's cost.
double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

SimulationResult simulate(const Workload& workload, RaySource& source, const MachineConfig& config,
                          const SimulationOptions& options) {
  const double began = thread_seconds();
  const std::vector<WarpPlace> places = list_warps(workload, options.frames);
  std::vector<std::uint32_t> chosen = options.warps;
  if (chosen.empty()) {
    chosen.resize(places.size());
    for (std::uint32_t i = 0; i < chosen.size(); ++i) {
      chosen[i] = i;
    }
  }
  for (const std::uint32_t warp : chosen) {
    if (warp >= places.size()) {
      throw UserError("warp " + std::to_string(warp) + " was asked for, but the workload has " +
                      std::to_string(places.size()));
    }
  }
  Machine machine(workload, source, config, options.stretch);
  SimulationResult result = machine.run(places, chosen, options.progress);
  result.host_seconds = thread_seconds() - began;
  return result;
}

}  // namespace a2rt::timing
