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
// The loads below take whole units apart; these say which words they find there.
static_assert(offsetof(RecordHeader, cursor) == 0 && offsetof(RecordHeader, capacity) == 4 &&
              offsetof(RecordHeader, dispatch) == 12);
static_assert(offsetof(RecordHeader, records) == 16 && offsetof(RecordHeader, ordinals) == 24);

}  // namespace

RecordWriter::RecordWriter(TypePool& types, std::uint64_t header_address)
    : header_address_(header_address) {
  constexpr auto kPhysical = spv::StorageClass::PhysicalStorageBuffer;
  // Device scope would need VulkanMemoryModelDeviceScope in a VulkanMemoryModel module, and the
  // queue family's scope exists only there.
  const bool vulkan_model = types.module().has_capability(spv::Capability::VulkanMemoryModel);
  scope_ = static_cast<std::uint32_t>(vulkan_model ? spv::Scope::QueueFamily : spv::Scope::Device);
  units_pointer_ = types.pointer_type(kPhysical, types.unbounded_block(types.uvec_type(4), 16));
  words_pointer_ = types.pointer_type(kPhysical, types.unbounded_block(types.uint_type(), 4));
  unit_pointer_ = types.pointer_type(kPhysical, types.uvec_type(4));
  word_pointer_ = types.pointer_type(kPhysical, types.uint_type());
  // What an entry point sees that sets no context: nothing is recorded, no launch id is touched.
  const auto other = static_cast<std::uint32_t>(capture::Stage::kOther) << 8;
  context_ = types.variable(spv::StorageClass::Private, types.uvec_type(4),
                            types.composite(types.uvec_type(4), {other, UINT32_MAX, 0, 0}));
}

void RecordWriter::set_context(CodeBuilder& code, capture::Stage stage, std::uint32_t shader,
                               Id launch) const {
  const std::uint32_t tag = static_cast<std::uint32_t>(stage) << 8 | shader << 16;
  code.store(context_, code.uvec4(code.constant(tag), launch, code.constant(1), code.constant(0)));
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

Id RecordWriter::header_word(CodeBuilder& code, Id header, std::size_t byte_offset) const {
  return code.emit(Op::OpAccessChain, word_pointer_,
                   {header, code.constant(0), code.constant(unit_of(byte_offset)),
                    code.constant(word_of(byte_offset))});
}

Id RecordWriter::atomic_add(CodeBuilder& code, Id pointer, Id value) const {
  return code.emit(Op::OpAtomicIAdd, code.types().uint_type(),
                   {pointer, code.constant(scope_), code.constant(0), value});
}

RecordSite RecordWriter::begin(CodeBuilder& code) const {
  RecordSite site;
  const Id context = code.load(code.types().uvec_type(4), context_);
  site.tag = code.component(context, 0);
  site.launch = code.component(context, 1);
  site.enabled = code.component(context, 2);
  const Id address =
      code.types().composite(code.types().uvec_type(2), {header_low(), header_high()});
  site.header = code.emit(Op::OpBitcast, units_pointer_, {address});
  const auto unit = [&](std::size_t byte) {
    return load_unit(code, site.header, code.constant(unit_of(byte)));
  };
  site.state = unit(offsetof(RecordHeader, cursor));
  site.addresses = unit(offsetof(RecordHeader, records));
  site.limits = unit(offsetof(RecordHeader, verdict_launches));
  const Id launches =
      code.component(site.limits, word_of(offsetof(RecordHeader, ordinal_launches)));
  const Id slot =
      code.select(code.compare(Op::OpULessThan, site.launch, launches), site.launch, launches);
  const Id ordinals =
      words_at(code, code.component(site.addresses, 2), code.component(site.addresses, 3));
  site.ordinal_ptr = word_pointer(code, ordinals, slot);
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

RecordPlace RecordWriter::open(CodeBuilder& code, const RecordSite& site, capture::RecordKind kind,
                               std::uint32_t units) const {
  const Id zero = code.constant(0);
  const Id count = code.constant(units);
  const Id cursor = code.component(site.state, 0);
  const Id capacity = code.component(site.state, 1);
  // A full buffer is left alone, so that the cursor cannot wrap around in a long run.
  const Id has_room =
      code.compare(Op::OpLogicalAnd, code.compare(Op::OpULessThan, cursor, capacity),
                   code.compare(Op::OpINotEqual, site.enabled, zero));
  const Id claimed =
      atomic_add(code, header_word(code, site.header, offsetof(RecordHeader, cursor)),
                 code.select(has_room, count, zero));
  const Id end = code.binary(Op::OpIAdd, claimed, count);
  const Id fits =
      code.compare(Op::OpLogicalAnd, has_room, code.compare(Op::OpULessThanEqual, end, capacity));
  atomic_add(code, header_word(code, site.header, offsetof(RecordHeader, lost)),
             code.select(fits, zero, site.enabled));

  RecordPlace place;
  place.base = units_at(code, code.component(site.addresses, 0), code.component(site.addresses, 1));
  place.offset = code.select(fits, claimed, capacity);
  const Id first =
      code.binary(Op::OpBitwiseOr, site.tag, code.constant(static_cast<std::uint32_t>(kind)));
  put(code, place, 0, code.uvec4(first, site.launch, code.component(site.state, 3), site.ordinal));
  return place;
}

void RecordWriter::put(CodeBuilder& code, const RecordPlace& place, std::uint32_t unit,
                       Id value) const {
  const Id index =
      unit == 0 ? place.offset : code.binary(Op::OpIAdd, place.offset, code.constant(unit));
  const Id pointer =
      code.emit(Op::OpAccessChain, unit_pointer_, {place.base, code.constant(0), index});
  code.store_aligned(pointer, value, kUnitBytes);
}

void RecordWriter::put_word(CodeBuilder& code, const RecordPlace& place, std::uint32_t unit,
                            std::uint32_t word, Id value) const {
  const Id index = code.binary(Op::OpIAdd, place.offset, code.constant(unit));
  const Id pointer = code.emit(Op::OpAccessChain, word_pointer_,
                               {place.base, code.constant(0), index, code.constant(word)});
  code.store_aligned(pointer, value, kWordBytes);
}

}  // namespace a2rt::spirv
