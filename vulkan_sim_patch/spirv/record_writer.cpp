#include "spirv/record_writer.h"

#include <cstddef>

namespace a2rt::spirv {
namespace {

using capture::RecordHeader;
using spv::Op;

constexpr std::uint32_t kUnitBytes = capture::kUnitBytes;
constexpr std::uint32_t kWordBytes = 4;

constexpr std::uint32_t unit_of(std::size_t byte) {
  return static_cast<std::uint32_t>(byte / kUnitBytes);
}
constexpr std::uint32_t word_of(std::size_t byte) {
  return static_cast<std::uint32_t>(byte % kUnitBytes / kWordBytes);
}
// The Private variables: {tag, launch, enabled, dispatch}, {records, ordinals} as in the header,
// {capacity, verdict_launches, ordinal_launches, 0}.
enum Variable : std::size_t { kContext, kAddresses, kLimits, kVariables };
static_assert(offsetof(RecordHeader, ordinals) == offsetof(RecordHeader, records) + 8 &&
              offsetof(RecordHeader, records) % kUnitBytes == 0);

}  // namespace

RecordWriter::RecordWriter(TypePool& types, AppendFunctions& appends, std::uint64_t header_address)
    : appends_(appends), header_address_(header_address) {
  constexpr auto kPhysical = spv::StorageClass::PhysicalStorageBuffer;
  // Device scope would need VulkanMemoryModelDeviceScope in a VulkanMemoryModel module, and the
  // queue family's scope exists only there.
  const bool vulkan_model = types.module().has_capability(spv::Capability::VulkanMemoryModel);
  scope_ = static_cast<std::uint32_t>(vulkan_model ? spv::Scope::QueueFamily : spv::Scope::Device);
  units_pointer_ = types.pointer_type(kPhysical, types.unbounded_block(types.uvec_type(4), 16));
  words_pointer_ = types.pointer_type(kPhysical, types.unbounded_block(types.uint_type(), 4));
  unit_pointer_ = types.pointer_type(kPhysical, types.uvec_type(4));
  word_pointer_ = types.pointer_type(kPhysical, types.uint_type());
  const Id type = types.uvec_type(4);
  const Id zero = types.composite(type, {0, 0, 0, 0});
  for (std::size_t i = 0; i < kVariables; ++i) {
    variables_.push_back(types.variable(spv::StorageClass::Private, type, zero));
  }
}

void RecordWriter::enter(CodeBuilder& code, capture::Stage stage, std::uint32_t shader, Id launch,
                         bool enabled) const {
  const Id block = header(code);
  const auto unit = [&](std::size_t byte) {
    return load_unit(code, block, code.constant(unit_of(byte)));
  };
  const Id state = unit(offsetof(RecordHeader, cursor));
  const Id limits = unit(offsetof(RecordHeader, verdict_launches));
  const std::uint32_t tag = static_cast<std::uint32_t>(stage) << 8 | shader << 16;
  code.store(variables_[kContext],
             code.uvec4(code.constant(tag), launch, code.constant(enabled ? 1 : 0),
                        code.component(state, word_of(offsetof(RecordHeader, dispatch)))));
  code.store(variables_[kAddresses], unit(offsetof(RecordHeader, records)));
  code.store(variables_[kLimits],
             code.uvec4(code.component(state, word_of(offsetof(RecordHeader, capacity))),
                        code.component(limits, word_of(offsetof(RecordHeader, verdict_launches))),
                        code.component(limits, word_of(offsetof(RecordHeader, ordinal_launches))),
                        code.constant(0)));
}

Id RecordWriter::header(CodeBuilder& code) const {
  const Id address =
      code.types().composite(code.types().uvec_type(2), {header_low(), header_high()});
  return code.emit(Op::OpBitcast, units_pointer_, {address});
}

Id RecordWriter::at_address(CodeBuilder& code, Id pointer_type, Id low, Id high) const {
  const Id address = code.emit(Op::OpCompositeConstruct, code.types().uvec_type(2), {low, high});
  return code.emit(Op::OpBitcast, pointer_type, {address});
}

Id RecordWriter::units_at(CodeBuilder& code, Id low, Id high) const {
  return at_address(code, units_pointer_, low, high);
}

Id RecordWriter::words_at(CodeBuilder& code, Id low, Id high) const {
  return at_address(code, words_pointer_, low, high);
}

Id RecordWriter::load_unit(CodeBuilder& code, Id units, Id index) const {
  const Id pointer = code.emit(Op::OpAccessChain, unit_pointer_, {units, code.constant(0), index});
  return code.load_aligned(code.types().uvec_type(4), pointer, kUnitBytes);
}

Id RecordWriter::word_pointer(CodeBuilder& code, Id words, Id index) const {
  return code.emit(Op::OpAccessChain, word_pointer_, {words, code.constant(0), index});
}

Id RecordWriter::load_word(CodeBuilder& code, Id words, Id index) const {
  return code.load_aligned(code.types().uint_type(), word_pointer(code, words, index), kWordBytes);
}

Id RecordWriter::header_word(CodeBuilder& code, std::size_t byte_offset) const {
  return code.emit(Op::OpAccessChain, word_pointer_,
                   {header(code), code.constant(0), code.constant(unit_of(byte_offset)),
                    code.constant(word_of(byte_offset))});
}

Id RecordWriter::atomic_add(CodeBuilder& code, Id pointer, Id value) const {
  return code.emit(Op::OpAtomicIAdd, code.types().uint_type(),
                   {pointer, code.constant(scope_), code.constant(0), value});
}

RecordSite RecordWriter::context(CodeBuilder& code) const {
  const auto variable = [&](Variable which) {
    return code.load(code.types().uvec_type(4), variables_[which]);
  };
  const Id context = variable(kContext);
  const Id addresses = variable(kAddresses);
  const Id limits = variable(kLimits);
  RecordSite site;
  site.tag = code.component(context, 0);
  site.launch = code.component(context, 1);
  site.enabled = code.component(context, 2);
  site.dispatch = code.component(context, 3);
  site.records = units_at(code, code.component(addresses, 0), code.component(addresses, 1));
  site.capacity = code.component(limits, 0);
  site.verdict_launches = code.component(limits, 1);
  site.ordinals = words_at(code, code.component(addresses, 2), code.component(addresses, 3));
  site.ordinal_launches = code.component(limits, 2);
  return site;
}

RecordSite RecordWriter::begin(CodeBuilder& code) const {
  RecordSite site = context(code);
  const Id launches = site.ordinal_launches;
  const Id slot =
      code.select(code.compare(Op::OpULessThan, site.launch, launches), site.launch, launches);
  site.ordinal_ptr = word_pointer(code, site.ordinals, slot);
  site.ordinal = code.load_aligned(code.types().uint_type(), site.ordinal_ptr, kWordBytes);
  return site;
}

void RecordWriter::reset_ordinal(CodeBuilder& code, const RecordSite& site) const {
  code.store_aligned(site.ordinal_ptr, code.constant(0), kWordBytes);
}

void RecordWriter::advance_ordinal(CodeBuilder& code, const RecordSite& site) const {
  code.store_aligned(site.ordinal_ptr, code.binary(Op::OpIAdd, site.ordinal, code.constant(1)),
                     kWordBytes);
}

RecordWriter::Claim RecordWriter::claim(CodeBuilder& code, const RecordSite& site,
                                        std::uint32_t units) const {
  const Id zero = code.constant(0);
  const Id count = code.constant(units);
  const Id cursor_ptr = header_word(code, offsetof(RecordHeader, cursor));
  const Id cursor = code.load_aligned(code.types().uint_type(), cursor_ptr, kWordBytes);
  // A full buffer is left alone, so that the cursor cannot wrap around in a long run.
  const Id has_room =
      code.compare(Op::OpLogicalAnd, code.compare(Op::OpULessThan, cursor, site.capacity),
                   code.compare(Op::OpINotEqual, site.enabled, zero));
  const Id claimed = atomic_add(code, cursor_ptr, code.select(has_room, count, zero));
  const Id end = code.binary(Op::OpIAdd, claimed, count);
  return {claimed, code.compare(Op::OpLogicalAnd, has_room,
                                code.compare(Op::OpULessThanEqual, end, site.capacity))};
}

Id RecordWriter::append(CodeBuilder& code, const RecordSite& site, capture::RecordKind kind,
                        std::initializer_list<Id> units) const {
  const auto count = static_cast<std::uint32_t>(units.size()) + 1;
  std::vector<Id> call{appends_.of(*this, count), code.constant(static_cast<std::uint32_t>(kind)),
                       site.ordinal};
  call.insert(call.end(), units);
  return code.emit(Op::OpFunctionCall, code.types().uint_type(), call);
}

void RecordWriter::count_lost(CodeBuilder& code, const RecordSite& site) const {
  atomic_add(code, header_word(code, offsetof(RecordHeader, lost)), site.enabled);
}

void RecordWriter::put(CodeBuilder& code, const RecordSite& site, Id offset, Id value) const {
  const Id pointer =
      code.emit(Op::OpAccessChain, unit_pointer_, {site.records, code.constant(0), offset});
  code.store_aligned(pointer, value, kUnitBytes);
}

void RecordWriter::put_word(CodeBuilder& code, const RecordSite& site, Id place, std::uint32_t unit,
                            std::uint32_t word, Id value) const {
  const Id index = code.binary(Op::OpIAdd, place, code.constant(unit));
  const Id pointer = code.emit(Op::OpAccessChain, word_pointer_,
                               {site.records, code.constant(0), index, code.constant(word)});
  code.store_aligned(pointer, value, kWordBytes);
}

}  // namespace a2rt::spirv
