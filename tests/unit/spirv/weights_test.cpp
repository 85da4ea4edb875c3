#include "spirv/weights.h"

#include <gtest/gtest.h>

#include <map>

#include "test_modules.h"

namespace a2rt::spirv {
namespace {

using capture::Counter;

Weights of(std::initializer_list<std::pair<Counter, std::uint32_t>> parts) {
  Weights w;
  for (const auto& [counter, amount] : parts) {
    w[counter] = amount;
  }
  return w;
}

std::map<std::string, Weights> weights_by_name(const Module& module) {
  std::map<std::string, Weights> found;
  const WeightTable table(module);
  for (const Instruction& instruction : module.globals()) {
    if (instruction.op() == spv::Op::OpName) {
      const Instruction* const named = module.definition(instruction.operand(0));
      if (named != nullptr && named->type() != 0) {
        found[instruction.string_operand(1)] = table.weigh(*named);
      }
    }
  }
  return found;
}

TEST(Weights, EveryInstructionWeighsWhatItsHeaderSays) {
  using enum Counter;
  const std::map<std::string, Weights> expected{
      {"fadd", of({{kAlu, 3}})},
      {"fdiv", of({{kAlu, 3}, {kSfu, 3}})},
      {"idiv", of({{kAlu, 1}, {kSfu, 1}})},
      {"dot", of({{kAlu, 5}})},
      {"scaled", of({{kAlu, 4}})},
      {"matvec", of({{kAlu, 28}})},
      {"vecmat", of({{kAlu, 15}})},
      {"matmat", of({{kAlu, 45}})},
      {"convert", of({{kAlu, 3}})},
      {"bits", of({})},
      {"compare", of({{kAlu, 3}})},
      {"any", of({{kAlu, 3}})},
      {"choose", of({{kAlu, 3}})},
      {"construct", of({})},
      {"shuffle", of({})},
      {"sin", of({{kSfu, 3}})},
      {"pow", of({{kSfu, 1}})},
      {"mix", of({{kAlu, 9}})},
      {"clamp", of({{kAlu, 6}})},
      {"cross", of({{kAlu, 9}})},
      {"normalize", of({{kAlu, 8}, {kSfu, 1}})},
      {"length", of({{kAlu, 5}, {kSfu, 1}})},
      {"reflect", of({{kAlu, 12}})},
      {"inverse", of({{kAlu, 41}, {kSfu, 1}})},
      {"print", of({})},
      {"load_uniform", of({{kUniformLoad, 4}})},
      {"load_matrix", of({{kUniformLoad, 16}})},
      {"load_struct", of({{kBufferLoad, 3 + 1 + 16}})},
      {"load_buffer", of({{kBufferLoad, 3}})},
      {"load_private", of({})},
      {"atomic", of({{kBufferStore, 1}})},
      {"atomic_load", of({{kBufferLoad, 1}})},
      {"fetched", of({})},
      {"read", of({{kTexture, 1}})},
      {"call", of({{kControl, 1}})},
  };
  const auto measured = weights_by_name(Module::parse(testing::module_named("weights.asm")));
  for (const auto& [name, weights] : expected) {
    ASSERT_TRUE(measured.contains(name)) << name;
    EXPECT_EQ(measured.at(name).count, weights.count) << name;
  }
  EXPECT_EQ(measured.size(), expected.size());
}

TEST(Weights, StoresAndBranchesAreCountedToo) {
  const Module module = Module::parse(testing::module_named("weights.asm"));
  const WeightTable table(module);
  Weights all;
  for (const Instruction& instruction : module.functions().back().code) {
    if (instruction.result() == 0) {
      all += table.weigh(instruction);
    }
  }
  // Stores: three words to the buffer, four to a private variable. One image write, one branch.
  EXPECT_EQ(all.count,
            of({{Counter::kBufferStore, 3}, {Counter::kTexture, 1}, {Counter::kControl, 1}}).count);
}

// Sum over all functions of a shader.
Weights total(const std::string& name) {
  const Module module = Module::parse(testing::module_named(name));
  const WeightTable table(module);
  Weights all;
  for (const Function& function : module.functions()) {
    for (const Instruction& instruction : function.code) {
      all += table.weigh(instruction);
    }
  }
  return all;
}

TEST(Weights, DebugInformationCountsNothing) {
  for (const std::string shader : {"raygen.rgen", "recursive.rchit", "query.comp"}) {
    EXPECT_EQ(total(shader + ".debug").count, total(shader + ".v13").count) << shader;
  }
}

TEST(Weights, PayloadsHitAttributesAndShaderRecordsArePayload) {
  // payload.w and child loaded; tint; two barycentrics one by one or as vec2; child and payload
  // stored: the exact sum stands for the shader's text.
  const Weights w = total("recursive.rchit.v13");
  EXPECT_EQ(w[Counter::kPayload], 1u + 4u + 4u + 2u + 4u + 4u);
  EXPECT_EQ(w[Counter::kBufferLoad], 4u);
  EXPECT_EQ(w[Counter::kUniformLoad], 0u);
}

}  // namespace
}  // namespace a2rt::spirv
