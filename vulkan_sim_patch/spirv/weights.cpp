#include "spirv/weights.h"

#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>

namespace a2rt::spirv {
namespace {

using capture::Counter;
using spv::Op;
using spv::StorageClass;

// A damaged module can nest types in circles; real ones stay far below.
constexpr int kMaxTypeDepth = 24;
constexpr std::uint64_t kMaxBits = std::uint64_t{1} << 36;

bool between(Op op, Op first, Op last) { return op >= first && op <= last; }

bool is_texture(Op op) {
  return between(op, Op::OpImageSampleImplicitLod, Op::OpImageWrite) ||
         between(op, Op::OpImageQuerySizeLod, Op::OpImageQuerySamples) ||
         between(op, Op::OpImageSparseSampleImplicitLod, Op::OpImageSparseDrefGather) ||
         op == Op::OpImageSparseRead;
}

bool is_query_getter(Op op) {
  return op == Op::OpRayQueryGetIntersectionTypeKHR ||
         between(op, Op::OpRayQueryGetRayTMinKHR, Op::OpRayQueryGetIntersectionWorldToObjectKHR);
}

bool is_atomic(Op op) {
  return between(op, Op::OpAtomicLoad, Op::OpAtomicXor) || op == Op::OpAtomicFAddEXT ||
         op == Op::OpAtomicFMinEXT || op == Op::OpAtomicFMaxEXT;
}

bool is_per_component(Op op) {
  return between(op, Op::OpConvertFToU, Op::OpQuantizeToF16) || op == Op::OpSatConvertSToU ||
         op == Op::OpSatConvertUToS || between(op, Op::OpSNegate, Op::OpFMul) ||
         op == Op::OpVectorTimesScalar || op == Op::OpMatrixTimesScalar ||
         op == Op::OpOuterProduct || between(op, Op::OpIsNan, Op::OpFUnordGreaterThanEqual) ||
         between(op, Op::OpShiftRightLogical, Op::OpBitCount) ||
         between(op, Op::OpDPdx, Op::OpFwidthCoarse) ||
         between(op, Op::OpGroupNonUniformElect, Op::OpGroupNonUniformQuadSwap);
}

bool is_control(Op op) {
  return op == Op::OpBranch || op == Op::OpBranchConditional || op == Op::OpSwitch ||
         op == Op::OpFunctionCall || op == Op::OpControlBarrier;
}

std::uint32_t dot_cost(std::uint32_t m) { return m == 0 ? 0 : 2 * m - 1; }

std::uint32_t determinant_cost(std::uint32_t k) {
  return k <= 1 ? 0 : k == 2 ? 3 : k * determinant_cost(k - 1) + dot_cost(k);
}

std::uint32_t inverse_cost(std::uint32_t k) {
  return k * k * determinant_cost(k - 1) + dot_cost(k) + k * k;
}

// ALU operations per component of the result for instructions that work component by component.
std::uint32_t extended_alu(std::uint32_t instruction) {
  switch (instruction) {
    case GLSLstd450FClamp:
    case GLSLstd450UClamp:
    case GLSLstd450SClamp:
    case GLSLstd450NClamp:
    case GLSLstd450Modf:
      return 2;
    case GLSLstd450FMix:
    case GLSLstd450IMix:
      return 3;
    case GLSLstd450SmoothStep:
      return 9;
    default:
      return 1;
  }
}

}  // namespace

Weights& Weights::operator+=(const Weights& other) {
  for (std::size_t i = 0; i < count.size(); ++i) {
    count[i] += other.count[i];
  }
  return *this;
}

WeightTable::WeightTable(const Module& module) : module_(module) {
  for (const Instruction& instruction : module.globals()) {
    if (instruction.op() == Op::OpExtInstImport &&
        instruction.string_operand(0) == "GLSL.std.450") {
      glsl_sets_.insert(instruction.result());
    }
    if (instruction.op() == Op::OpDecorate &&
        instruction.operand(1) == static_cast<std::uint32_t>(spv::Decoration::BufferBlock)) {
      buffer_structs_.insert(instruction.operand(0));
    }
  }
}

Weights WeightTable::weigh(const Instruction& instruction) const {
  const Op op = instruction.op();
  Weights w;
  if (op == Op::OpLoad || op == Op::OpStore || op == Op::OpCopyMemory) {
    weigh_memory(instruction, w);
  } else if (op == Op::OpExtInst) {
    weigh_extended(instruction, w);
  } else if (is_texture(op)) {
    w[Counter::kTexture] = 1;
  } else if (is_atomic(op)) {
    weigh_atomic(instruction, w);
  } else if (is_query_getter(op)) {
    w[Counter::kPayload] = words(instruction.type());
  } else if (is_control(op)) {
    w[Counter::kControl] = 1;
  } else if (is_per_component(op)) {
    w[Counter::kAlu] = components(instruction.type());
  } else {
    weigh_arithmetic(instruction, w);
  }
  return w;
}

void WeightTable::weigh_arithmetic(const Instruction& instruction, Weights& w) const {
  const std::uint32_t n = components(instruction.type());
  switch (instruction.op()) {
    case Op::OpUDiv:
    case Op::OpSDiv:
    case Op::OpFDiv:
    case Op::OpUMod:
    case Op::OpSRem:
    case Op::OpSMod:
    case Op::OpFRem:
    case Op::OpFMod:
      w[Counter::kAlu] = w[Counter::kSfu] = n;
      break;
    case Op::OpDot:
      w[Counter::kAlu] = dot_cost(components_of(instruction.operand(0)));
      break;
    case Op::OpVectorTimesMatrix:
      w[Counter::kAlu] = n * dot_cost(components_of(instruction.operand(0)));
      break;
    case Op::OpMatrixTimesVector:
      w[Counter::kAlu] = n * dot_cost(components_of(instruction.operand(1)));
      break;
    case Op::OpMatrixTimesMatrix: {
      const Instruction* const left = module_.definition(module_.type_of(instruction.operand(0)));
      const bool is_matrix = left != nullptr && left->op() == Op::OpTypeMatrix;
      w[Counter::kAlu] = n * dot_cost(is_matrix ? std::min(left->operand(1), 4u) : 1);
      break;
    }
    case Op::OpIAddCarry:
    case Op::OpISubBorrow:
    case Op::OpUMulExtended:
    case Op::OpSMulExtended:
      w[Counter::kAlu] = 2 * components_of(instruction.operand(0));
      break;
    case Op::OpAny:
    case Op::OpAll:
      w[Counter::kAlu] = components_of(instruction.operand(0));
      break;
    case Op::OpImageSparseTexelsResident:
      w[Counter::kAlu] = 1;
      break;
    default:
      break;
  }
}

void WeightTable::weigh_extended(const Instruction& instruction, Weights& w) const {
  if (!glsl_sets_.contains(instruction.operand(0))) {
    return;
  }
  const std::uint32_t which = instruction.operand(1);
  const std::uint32_t n = components(instruction.type());
  const std::uint32_t m =
      instruction.operand_count() > 2 ? components_of(instruction.operand(2)) : 0;
  std::uint32_t& alu = w[Counter::kAlu];
  std::uint32_t& sfu = w[Counter::kSfu];
  if (which >= GLSLstd450Sin && which <= GLSLstd450InverseSqrt) {
    sfu = n;
    return;
  }
  switch (which) {
    case GLSLstd450Determinant:
    case GLSLstd450MatrixInverse: {
      const Instruction* const type = module_.definition(module_.type_of(instruction.operand(2)));
      const bool is_matrix = type != nullptr && type->op() == Op::OpTypeMatrix;
      const std::uint32_t k = is_matrix ? std::min(type->operand(1), 4u) : 1;
      alu = which == GLSLstd450Determinant ? determinant_cost(k) : inverse_cost(k);
      sfu = which == GLSLstd450MatrixInverse ? 1 : 0;
      break;
    }
    case GLSLstd450Length:
      alu = dot_cost(m);
      sfu = 1;
      break;
    case GLSLstd450Distance:
      alu = m + dot_cost(m);
      sfu = 1;
      break;
    case GLSLstd450Cross:
      alu = 9;
      break;
    case GLSLstd450Normalize:
      alu = m + dot_cost(m);
      sfu = 1;
      break;
    case GLSLstd450FaceForward:
      alu = dot_cost(m) + 1 + m;
      break;
    case GLSLstd450Reflect:
      alu = 4 * m;
      break;
    case GLSLstd450Refract:
      alu = dot_cost(m) + 8 + 3 * m;
      sfu = 1;
      break;
    case GLSLstd450SmoothStep:
      alu = 9 * n;
      sfu = n;
      break;
    default: {
      const bool packs = which >= GLSLstd450PackSnorm4x8 && which <= GLSLstd450UnpackDouble2x32;
      alu = packs ? 2 * std::max(n, m) : extended_alu(which) * n;
      break;
    }
  }
}

void WeightTable::weigh_atomic(const Instruction& instruction, Weights& w) const {
  const bool is_store = instruction.op() == Op::OpAtomicStore;
  const Id pointer = instruction.operand(0);
  Counter counter{};
  if (!memory_counter(pointer, instruction.op() != Op::OpAtomicLoad, counter)) {
    return;
  }
  const bool is_image = counter == Counter::kTexture;
  const Id type = is_store && instruction.operand_count() > 3
                      ? module_.type_of(instruction.operand(3))
                      : instruction.type();
  w[counter] += is_image ? 1 : words(type);
}

void WeightTable::weigh_memory(const Instruction& instruction, Weights& w) const {
  Counter counter{};
  const auto pointee = [&](Id pointer) {
    const Instruction* const type = module_.definition(module_.type_of(pointer));
    return type != nullptr && type->op() == Op::OpTypePointer ? type->operand(1) : 0;
  };
  if (instruction.op() == Op::OpLoad) {
    if (memory_counter(instruction.operand(0), false, counter)) {
      w[counter] += words(instruction.type());
    }
    return;
  }
  const Id target = instruction.operand(0);
  const Id source = instruction.operand(1);
  if (memory_counter(target, true, counter)) {
    w[counter] += words(pointee(target));
  }
  if (instruction.op() == Op::OpCopyMemory && memory_counter(source, false, counter)) {
    w[counter] += words(pointee(source));
  }
}

bool WeightTable::memory_counter(Id pointer, bool is_store, Counter& counter) const {
  const Instruction* const type = module_.definition(module_.type_of(pointer));
  if (type == nullptr || type->op() != Op::OpTypePointer) {
    return false;
  }
  const Counter buffer = is_store ? Counter::kBufferStore : Counter::kBufferLoad;
  switch (static_cast<StorageClass>(type->operand(0))) {
    case StorageClass::Uniform: {
      // The struct is the pointee of the variable, found behind any access chain.
      const Instruction* base = module_.definition(pointer);
      for (int i = 0; i < kMaxTypeDepth && base != nullptr && base->op() != Op::OpVariable; ++i) {
        base = base->operand_count() > 0 ? module_.definition(base->operand(0)) : nullptr;
      }
      const Instruction* const holder =
          base != nullptr ? module_.definition(base->type()) : nullptr;
      const bool is_buffer = holder != nullptr && holder->op() == Op::OpTypePointer &&
                             buffer_structs_.contains(holder->operand(1));
      counter = is_buffer ? buffer : Counter::kUniformLoad;
      return true;
    }
    case StorageClass::PushConstant:
      counter = Counter::kUniformLoad;
      return true;
    case StorageClass::StorageBuffer:
    case StorageClass::PhysicalStorageBuffer:
      counter = buffer;
      return true;
    case StorageClass::Image:
      counter = Counter::kTexture;
      return true;
    case StorageClass::CallableDataKHR:
    case StorageClass::IncomingCallableDataKHR:
    case StorageClass::RayPayloadKHR:
    case StorageClass::HitAttributeKHR:
    case StorageClass::IncomingRayPayloadKHR:
    case StorageClass::ShaderRecordBufferKHR:
      counter = Counter::kPayload;
      return true;
    default:
      return false;
  }
}

std::uint32_t WeightTable::components(Id type) const {
  const Instruction* const declared = module_.definition(type);
  if (declared == nullptr) {
    return type == 0 ? 0 : 1;
  }
  if (declared->op() == Op::OpTypeVector) {
    return std::min(declared->operand(1), 16u);
  }
  if (declared->op() == Op::OpTypeMatrix) {
    const Instruction* const column = module_.definition(declared->operand(0));
    const std::uint32_t rows = column != nullptr && column->op() == Op::OpTypeVector
                                   ? std::min(column->operand(1), 16u)
                                   : 1;
    return rows * std::min(declared->operand(1), 16u);
  }
  return 1;
}

std::uint32_t WeightTable::words(Id type) const {
  return static_cast<std::uint32_t>((bits(type, 0) + 31) / 32);
}

std::uint64_t WeightTable::bits(Id type, int depth) const {
  const Instruction* const declared = module_.definition(type);
  if (declared == nullptr || depth > kMaxTypeDepth) {
    return 0;
  }
  const auto known = bits_.find(type);
  if (known != bits_.end()) {
    return known->second;
  }
  bits_[type] = 0;  // what a circle finds
  std::uint64_t total = 0;
  switch (declared->op()) {
    case Op::OpTypeBool:
      total = 32;
      break;
    case Op::OpTypeInt:
    case Op::OpTypeFloat:
      total = std::min(declared->operand(0), 64u);
      break;
    case Op::OpTypePointer:
      total = 64;
      break;
    case Op::OpTypeVector:
    case Op::OpTypeMatrix:
      total = bits(declared->operand(0), depth + 1) * std::min(declared->operand(1), 16u);
      break;
    case Op::OpTypeArray: {
      const Instruction* const length = module_.definition(declared->operand(1));
      const bool is_constant = length != nullptr && (length->op() == Op::OpConstant ||
                                                     length->op() == Op::OpSpecConstant);
      total = bits(declared->operand(0), depth + 1) * (is_constant ? length->operand(0) : 1u);
      break;
    }
    case Op::OpTypeStruct:
      for (const Id member : declared->operands()) {
        total = std::min(total + bits(member, depth + 1), kMaxBits);
      }
      break;
    default:
      break;
  }
  total = std::min(total, kMaxBits);
  bits_[type] = total;
  return total;
}

}  // namespace a2rt::spirv
