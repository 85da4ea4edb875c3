// Hit kind, t and ids of the candidate or hit a shader was started for.
//
// They are read once, at the entry of the shader: lavapipe keeps them in variables that a nested
// trace overwrites.
#pragma once

#include "spirv/entry_inputs.h"
#include "spirv/record_writer.h"

namespace a2rt::spirv {

struct HitWords {
  Id kind = 0, t = 0, primitive = 0, instance = 0, geometry = 0, custom = 0;  // as uint
};

class HitData {
 public:
  explicit HitData(TypePool& types);
  const std::vector<Id>& variables() const { return variables_; }

  // From the builtin inputs. An intersection shader has no hit yet: kind and t are 0.
  static HitWords read_inputs(CodeBuilder& code, EntryInputs& inputs, bool has_hit);
  // Keeps them for functions that several entry points may share, and takes them back.
  void keep(CodeBuilder& code, const HitWords& hit) const;
  HitWords kept(CodeBuilder& code) const;

  // Appends a kHit, kAnyHit or kReport record; `flag` is word 2 of its unit 2. Gives its place.
  static Id append(CodeBuilder& code, const RecordWriter& writer, const RecordSite& site,
                   capture::RecordKind kind, const HitWords& hit, Id flag);

 private:
  std::vector<Id> variables_;
};

}  // namespace a2rt::spirv
