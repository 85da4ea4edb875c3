// The L1 data cache of one SM, shared by its load/store unit and its RT unit, which both see its
// latency, banks and MSHRs.
//
// A read is looked up in the cycle its bank takes it and answered `latency` later; a miss leaves
// for L2 after the same latency (the lookup is at the end of the pipe, as in GPGPU-Sim). Lines are
// allocated when their data comes. Shader stores write through without allocating; spilled stacks
// and contexts, private to a thread, are kept and written back when evicted.
//
// The sectors of one message enter the cache in consecutive cycles, but their tags are looked up
// when the first does: what is filled or evicted meanwhile (a few cycles) does not show.
//
// In the model "reserved", reads know at once when they can be used (read_ahead()): ports, latency
// and MSHRs are as wide, but lines are allocated when they are asked for, tags looked up then, and
// neither banks nor the limit of requests that wait for one sector are modelled.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "a2rt/base/inline.h"
#include "a2rt/timing/arrival.h"
#include "a2rt/timing/budget.h"
#include "a2rt/timing/in_flight.h"
#include "a2rt/timing/machine_config.h"
#include "a2rt/timing/memory_port.h"
#include "a2rt/timing/tag_store.h"

namespace a2rt::timing {

class L1Client {
 public:
  virtual ~L1Client() = default;
  // Sectors of a read that had missed; `ready` says when each can be used, never before `now`.
  virtual void arrived(Cycles now, std::uint32_t token, SectorMask sectors,
                       const SectorTimes& ready) = 0;
  // An MSHR was freed after a read had been turned away.
  virtual void unblocked(Cycles now) = 0;
};

class L1Cache final : public LineSink {
 public:
  L1Cache(const L1Config& config, LowerLevel& lower, std::uint32_t sm);

  struct Lookup {
    SectorMask accepted =
        0;                // the others were turned away by full MSHRs, from the first of them on
    SectorMask hits = 0;  // of the accepted; the rest come by L1Client::arrived
    SectorTimes ready{};  // of the hits
    bool mshrs_full = false;
  };
  // Sends the sectors one by one through `port`, each in the first cycle in which port and bank are
  // free. When turned away, L1Client::unblocked tells when trying again makes sense.
  Lookup read(Cycles now, Port& port, Address line, SectorMask sectors, Traffic kind,
              L1Client& client, std::uint32_t token);
  void write(Cycles now, Port& port, Address line, SectorMask sectors, Traffic kind);
  // Model "reserved": the sectors are looked up now, and what misses reserves its way through the
  // levels below. Returns the cycle in which all of them can be used. `send(n)` gives n sectors
  // their turn at the port, whenever that is, and returns a Port::Sent. What is on its way to the
  // sharer (below Arrival::kReceivers) who asked for the line last is not sent again for it.
  template <class Send>
  Cycles read_ahead(Cycles now, std::uint32_t sharer, Address line, SectorMask sectors,
                    Traffic kind, const Send& send);
  // The same for who shares nothing.
  Cycles read_ahead(Port::Sent sent, Address line, SectorMask sectors, Traffic kind);
  void write_ahead(Cycles now, Port::Sent sent, Address line, SectorMask sectors, Traffic kind) {
    write_from(departure_of(sent, sectors_in(sectors)), now, line, sectors, kind);
  }
  // The line will be read soon: brings what that touches into the host's caches.
  void prefetch(Address line) const {
    tags_.prefetch(line);
    if (reserves_) {
      __builtin_prefetch(&ahead_[tags_.guess(line)], 1);
    }
  }

  void fill(Cycles now, Address line, SectorMask sectors) override;

  const CacheCounts& counts() const { return counts_; }
  const TagStore& tags() const { return tags_; }
  std::string dump() const;
  void check_drained() const;

 private:
  static constexpr std::uint32_t kNil = 0xffffffffu;
  static constexpr std::size_t kBuckets = 128;
  // A read of one client that waits for sectors of one line.
  struct Waiter {
    L1Client* client = nullptr;
    Cycles earliest;  // of the last sector
    std::uint32_t token = 0;
    SectorMask wanted = 0;
  };
  struct LaterWaiter {
    Waiter waiter;
    std::uint32_t next = kNil;
  };
  // The sectors of one line that are being fetched. One MSHR of the hardware holds one sector.
  // Mostly nobody but the read that missed waits for them.
  struct alignas(64) Pending {
    std::uint64_t line = 0;
    Waiter first;
    std::uint32_t later = kNil, last = kNil;  // those who came after the first
    std::uint32_t next = kNil;                // in its bucket
    std::uint32_t waiting = 0;
    SectorMask sectors = 0;
    Traffic kind = Traffic::kNone;
  };
  static std::size_t bucket(std::uint64_t line) {
    return mixed(line) >> (64 - std::bit_width(kBuckets - 1));
  }
  void enter(Cycles now, Port& port, Address line, SectorMask sectors, SectorTimes& ready);
  A2RT_NOINLINE void enter_one_by_one(Cycles now, Port& port, Address line, SectorMask sectors,
                                      SectorTimes& ready);
  A2RT_NOINLINE void miss(Cycles now, Port& port, Address line, SectorMask missing, Traffic kind,
                          L1Client& client, std::uint32_t token, Lookup& result);
  // Of a line in the tags.
  struct Ahead {
    Arrival from_below;  // at the cache
    Arrival to_sharer;
  };
  Ahead& enter_ahead(Cycles now, Held held, Address line, SectorMask sectors, Traffic kind,
                     bool dirty);
  Cycles look_up_ahead(Port::Sent sent, std::uint32_t n, Held held, Address line,
                       SectorMask sectors, Traffic kind);
  A2RT_NOINLINE Cycles wait_for_below(Cycles leaves, Cycles looked_up, Held held, Address line,
                                      SectorMask sectors, Traffic kind);
  Cycles miss_ahead(Cycles leaves, Cycles looked_up, Held held, Address line, SectorMask missing,
                    Traffic kind);
  // When the first of so many sectors, which follow each other a cycle apart, can leave for below.
  Cycles departure_of(Port::Sent sent, std::uint32_t n) const {
    return std::max(sent.first + Cycles{n - 1}, sent.last) - Cycles{n - 1} + config_.latency;
  }
  void write_from(Cycles leaves, Cycles now, Address line, SectorMask sectors, Traffic kind);
  std::uint32_t* find(std::uint64_t line);
  std::uint32_t obtain(std::uint64_t line, Traffic kind);
  void release(std::uint32_t& link);
  SectorMask mergeable(const Pending& pending, SectorMask sectors) const;
  void turn_away(L1Client& client);
  void add_waiter(Pending& pending, const Waiter& waiter);
  void answer(Cycles now, Pending& pending, SectorMask sectors);
  void count_victim(Cycles now, const std::optional<Victim>& victim);

  L1Config config_;
  LowerLevel& lower_;
  std::uint32_t sm_;
  bool reserves_;  // lower_ answers reads at once
  TagStore tags_;
  Banks banks_;
  std::vector<Pending> pending_;
  std::array<std::uint32_t, kBuckets> buckets_;
  std::uint32_t free_pending_ = kNil;
  std::uint32_t mshrs_used_ = 0;
  std::vector<LaterWaiter> waiters_;
  std::uint32_t free_waiter_ = kNil;
  std::uint32_t waiters_used_ = 0;
  std::vector<L1Client*> turned_away_;
  // Model "reserved".
  std::vector<Ahead> ahead_;  // by the line's place; the last one is nobody's
  InFlight in_flight_;
  CacheCounts counts_;
};

// Sends the sectors through the port and their banks; there is at least one.
A2RT_INLINE void L1Cache::enter(Cycles now, Port& port, Address line, SectorMask sectors,
                                SectorTimes& ready) {
  const Cycles wanted = port.next(now);
  const std::uint32_t n = sectors_in(sectors);
  const bool in_turn = port.simple();
  const Passage& passage = in_turn ? kInTurn[sectors] : kTogether[sectors];
  std::optional<Cycles> first;
  if (in_turn || port.fits(wanted, n)) {
    first = banks_.take_all(line_of(line), sectors, wanted, passage);
  }
  if (first) {
    in_turn ? port.use_in_turn(*first, n) : port.use(*first, n);
    counts_.bank_conflicts += first->value - wanted.value;
    for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
      ready[s] = *first + config_.latency + Cycles{passage.after[s]};
    }
  } else {
    enter_one_by_one(now, port, line, sectors, ready);
  }
}

A2RT_INLINE L1Cache::Lookup L1Cache::read(Cycles now, Port& port, Address line, SectorMask sectors,
                                          Traffic kind, L1Client& client, std::uint32_t token) {
  banks_.advance(now);
  Lookup result;
  result.hits = tags_.touch(line, sectors);
  counts_.hits[static_cast<std::size_t>(kind)] += sectors_in(result.hits);
  if (result.hits == sectors) {
    result.accepted = sectors;
    enter(now, port, line, sectors, result.ready);
  } else {
    miss(now, port, line, static_cast<SectorMask>(sectors & ~result.hits), kind, client, token,
         result);
  }
  counts_.reads[static_cast<std::size_t>(kind)] += sectors_in(result.accepted);
  return result;
}

A2RT_INLINE Cycles L1Cache::look_up_ahead(Port::Sent sent, std::uint32_t n, Held held, Address line,
                                          SectorMask sectors, Traffic kind) {
  const auto k = static_cast<std::size_t>(kind);
  const Cycles looked_up = sent.last + config_.latency;
  counts_.reads[k] += n;
  const auto missing = static_cast<SectorMask>(sectors & ~held.valid);
  const Arrival& from_below = ahead_[held.place].from_below;
  if (missing != 0 || from_below.there() > looked_up) [[unlikely]] {
    return wait_for_below(departure_of(sent, n), looked_up, held, line, sectors, kind);
  }
  counts_.hits[k] += n;
  tags_.use(line, held.place);
  return looked_up;
}

A2RT_INLINE Cycles L1Cache::read_ahead(Port::Sent sent, Address line, SectorMask sectors,
                                       Traffic kind) {
  return look_up_ahead(sent, sectors_in(sectors), tags_.look(line), line, sectors, kind);
}

template <class Send>
A2RT_INLINE Cycles L1Cache::read_ahead(Cycles now, std::uint32_t sharer, Address line,
                                       SectorMask sectors, Traffic kind, const Send& send) {
  const Held held = tags_.look(line);
  const Arrival known = ahead_[held.place].to_sharer.after(now, sharer);
  const auto wanted = static_cast<SectorMask>(sectors & ~known.sectors());
  if (wanted == 0) {
    return known.there();
  }
  const std::uint32_t n = sectors_in(wanted);
  const Cycles there = look_up_ahead(send(n), n, held, line, wanted, kind);
  const std::uint32_t place = held.place < tags_.places() ? held.place : tags_.look(line).place;
  const Arrival all = known.with(sharer, wanted, there);
  ahead_[place].to_sharer = all;
  return wanted == sectors ? there : all.there();
}

}  // namespace a2rt::timing
