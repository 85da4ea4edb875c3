#include "spirv/hit_data.h"

namespace a2rt::spirv {

using spv::BuiltIn;

HitData::HitData(TypePool& types) {
  const Id type = types.uvec_type(4);
  const Id zero = types.composite(type, {0, 0, 0, 0});
  for (int i = 0; i < 2; ++i) {
    variables_.push_back(types.variable(spv::StorageClass::Private, type, zero));
  }
}

HitWords HitData::read_inputs(CodeBuilder& code, EntryInputs& inputs, bool has_hit) {
  const Id uint = code.types().uint_type();
  const auto read = [&](BuiltIn builtin, Id type) {
    return code.as_uint(inputs.load(code, builtin, type));
  };
  HitWords hit;
  hit.kind = has_hit ? read(BuiltIn::HitKindKHR, uint) : code.constant(0);
  hit.t = has_hit ? read(BuiltIn::RayTmaxKHR, code.types().float_type()) : code.constant(0);
  hit.primitive = read(BuiltIn::PrimitiveId, uint);
  hit.instance = read(BuiltIn::InstanceId, uint);
  hit.geometry = read(BuiltIn::RayGeometryIndexKHR, uint);
  hit.custom = read(BuiltIn::InstanceCustomIndexKHR, uint);
  return hit;
}

void HitData::keep(CodeBuilder& code, const HitWords& hit) const {
  const Id zero = code.constant(0);
  code.store(variables_[0], code.uvec4(hit.kind, hit.t, hit.primitive, hit.instance));
  code.store(variables_[1], code.uvec4(hit.geometry, hit.custom, zero, zero));
}

HitWords HitData::kept(CodeBuilder& code) const {
  const Id a = code.load(code.types().uvec_type(4), variables_[0]);
  const Id b = code.load(code.types().uvec_type(4), variables_[1]);
  return {code.component(a, 0), code.component(a, 1), code.component(a, 2),
          code.component(a, 3), code.component(b, 0), code.component(b, 1)};
}

Id HitData::append(CodeBuilder& code, const RecordWriter& writer, const RecordSite& site,
                   capture::RecordKind kind, const HitWords& hit, Id flag) {
  return writer.append(code, site, kind,
                       {code.uvec4(hit.kind, hit.t, hit.primitive, hit.instance),
                        code.uvec4(hit.geometry, hit.custom, flag, code.constant(0))});
}

}  // namespace a2rt::spirv
