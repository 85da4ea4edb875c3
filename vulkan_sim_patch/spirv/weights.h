// What each SPIR-V instruction adds to the eight counters of capture::Counter.
//
// Weights are those of the SPIR-V as given, before any driver optimisation. n = components of the
// result (of the operand where said), m = components of a vector operand.
//
//   kAlu          n per arithmetic, conversion, comparison, logic, select, bit and derivative
//                 instruction; dot 2m-1; matrix products one dot per component; extended
//                 instructions as their usual expansion (clamp 2n, mix 3n, cross 9, reflect 4m,
//                 ...)
//   kSfu          n per transcendental, square root or division (division also counts n kAlu);
//                 length, distance, normalize 1
//   kUniformLoad  words loaded from uniform blocks and push constants
//   kBufferLoad   words loaded from storage buffers and device addresses, atomic loads
//   kBufferStore  words stored there; a read-modify-write atomic counts its word once, here
//   kTexture      sampling, fetching, reading, writing, querying, image atomics: 1 each
//   kPayload      words of ray and callable payloads, hit attributes, shader records, and of what
//                 the getters of a ray query return
//   kControl      branches, switches, calls and control barriers: 1 each
//
// Free: moves (construct, extract, shuffle, bitcast, phi), address arithmetic of access chains,
// function-local, private, workgroup and stage-interface variables, debug information, and the ray
// instructions themselves, which the RT unit executes.
#pragma once

#include <array>
#include <unordered_map>
#include <unordered_set>

#include "a2rt/capture/records.h"
#include "spirv/module.h"

namespace a2rt::spirv {

struct Weights {
  std::array<std::uint32_t, capture::kCounters> count{};

  std::uint32_t& operator[](capture::Counter c) { return count[static_cast<std::size_t>(c)]; }
  std::uint32_t operator[](capture::Counter c) const { return count[static_cast<std::size_t>(c)]; }
  Weights& operator+=(const Weights& other);
  bool operator==(const Weights&) const = default;
};

class WeightTable {
 public:
  explicit WeightTable(const Module& module);
  Weights weigh(const Instruction& instruction) const;

 private:
  std::uint32_t components(Id type) const;
  std::uint32_t components_of(Id value) const { return components(module_.type_of(value)); }
  std::uint32_t words(Id type) const;
  std::uint64_t bits(Id type, int depth) const;
  // The counter that memory behind `pointer` belongs to; false if it is free.
  bool memory_counter(Id pointer, bool is_store, capture::Counter& counter) const;
  void weigh_memory(const Instruction& instruction, Weights& w) const;
  void weigh_arithmetic(const Instruction& instruction, Weights& w) const;
  void weigh_extended(const Instruction& instruction, Weights& w) const;
  void weigh_atomic(const Instruction& instruction, Weights& w) const;

  const Module& module_;
  std::unordered_set<Id> glsl_sets_;       // ids of the GLSL.std.450 import
  std::unordered_set<Id> buffer_structs_;  // Uniform structs that are storage buffers (BufferBlock)
  mutable std::unordered_map<Id, std::uint64_t> bits_;
};

}  // namespace a2rt::spirv
