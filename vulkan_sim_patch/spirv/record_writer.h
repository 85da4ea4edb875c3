// Emits the code that appends one record to the record buffer (capture/records.h).
//
// Only the address of the RecordHeader is baked into the shader. The cursor is claimed with one
// atomic addition; a record that does not fit is counted as lost. The first such record leaves the
// units between its place and the buffer's end as they were, so a reader needs them zeroed
// beforehand: kind 0 ends the records. Record sites are straight-line code: OpSelect instead of
// branches, and calls of the functions of append_functions.h.
#pragma once

#include "a2rt/capture/records.h"
#include "spirv/append_functions.h"
#include "spirv/code.h"

namespace a2rt::spirv {

// Values a record site needs, loaded once per site.
struct RecordSite {
  Id tag = 0;      // stage << 8 | shader << 16
  Id launch = 0;   // linear launch id
  Id enabled = 0;  // 1, or 0 if an entry point that records nothing got here
  Id dispatch = 0;
  Id records = 0;  // pointer to the block of record units
  Id capacity = 0;
  Id verdict_launches = 0;
  Id ordinal_launches = 0;
  Id ordinals = 0;     // pointer to the block of ordinals
  Id ordinal_ptr = 0;  // of this launch id; only begin() fills in this and the next
  Id ordinal = 0;      // its value
};

class RecordWriter {
 public:
  RecordWriter(TypePool& types, AppendFunctions& appends, std::uint64_t header_address);

  // Private variables that enter() sets and every site reads: what the header says does not change
  // during a dispatch, and loads from memory are dear.
  const std::vector<Id>& variables() const { return variables_; }
  // Must run before any site. With `enabled` false sites write nothing.
  void enter(CodeBuilder& code, capture::Stage stage, std::uint32_t shader, Id launch,
             bool enabled) const;

  RecordSite begin(CodeBuilder& code) const;
  // What enter() keeps, without the ordinal of the launch id.
  RecordSite context(CodeBuilder& code) const;
  void reset_ordinal(CodeBuilder& code, const RecordSite& site) const;
  void advance_ordinal(CodeBuilder& code, const RecordSite& site) const;

  // Appends a record whose units after the first are `units`. The result is its place in units;
  // for a record that is lost, the place of the spare units.
  Id append(CodeBuilder& code, const RecordSite& site, capture::RecordKind kind,
            std::initializer_list<Id> units) const;
  // Replaces one word of a record already written.
  void put_word(CodeBuilder& code, const RecordSite& site, Id place, std::uint32_t unit,
                std::uint32_t word, Id value) const;

  // The parts of append().
  struct Claim {
    Id offset = 0;  // in units
    Id fits = 0;    // bool
  };
  Claim claim(CodeBuilder& code, const RecordSite& site, std::uint32_t units) const;
  void put(CodeBuilder& code, const RecordSite& site, Id offset, Id value) const;
  void count_lost(CodeBuilder& code, const RecordSite& site) const;

  // Blocks of 16-byte units and of words at a physical address (two words, low first).
  Id units_at(CodeBuilder& code, Id low, Id high) const;
  Id words_at(CodeBuilder& code, Id low, Id high) const;
  Id load_unit(CodeBuilder& code, Id units, Id index) const;
  Id load_word(CodeBuilder& code, Id words, Id index) const;
  Id header(CodeBuilder& code) const;  // block of units
  // Address of the header.
  std::uint32_t header_low() const { return static_cast<std::uint32_t>(header_address_); }
  std::uint32_t header_high() const { return static_cast<std::uint32_t>(header_address_ >> 32); }

 private:
  Id word_pointer(CodeBuilder& code, Id words, Id index) const;
  Id at_address(CodeBuilder& code, Id pointer_type, Id low, Id high) const;
  Id header_word(CodeBuilder& code, std::size_t byte_offset) const;
  Id atomic_add(CodeBuilder& code, Id pointer, Id value) const;

  AppendFunctions& appends_;
  std::uint64_t header_address_;
  std::uint32_t scope_;
  std::vector<Id> variables_;  // see kContext .. kLimits in the source
  Id units_pointer_ = 0;       // type: pointer to a block of uvec4
  Id words_pointer_ = 0;       // type: pointer to a block of uint
  Id unit_pointer_ = 0;        // type: pointer to uvec4
  Id word_pointer_ = 0;        // type: pointer to uint
};

}  // namespace a2rt::spirv
