#include "spirv/module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_modules.h"

namespace a2rt::spirv {
namespace {

using testing::all_modules;
using ::testing::HasSubstr;

std::string refusal(const std::vector<std::uint32_t>& words) {
  try {
    Module::parse(words);
  } catch (const SpirvError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Module, WritingWhatWasParsedGivesTheSameBits) {
  ASSERT_GT(all_modules().size(), 60u);
  for (const auto& module : all_modules()) {
    EXPECT_EQ(Module::parse(module.words).words(), module.words) << module.name;
  }
}

TEST(Module, KnowsDefinitionsAndTypes) {
  const Module module = Module::parse(testing::module_named("twice.asm"));
  ASSERT_EQ(module.functions().size(), 1u);
  const Function& main = module.functions()[0];
  ASSERT_NE(module.function(main.id), nullptr);
  EXPECT_EQ(module.definition(main.id)->op(), spv::Op::OpFunction);
  EXPECT_EQ(module.type_op(module.type_of(main.id)), spv::Op::OpTypeVoid);
  EXPECT_EQ(module.definition(12345), nullptr);
  EXPECT_TRUE(module.unknown_opcodes().empty());
}

TEST(Module, NamesTheWordWhereTheModuleIsDamaged) {
  std::vector<std::uint32_t> words = testing::module_named("twice.asm");
  EXPECT_THAT(refusal({}), HasSubstr("word 0: the module ends inside its header"));

  auto swapped = words;
  swapped[0] = 0x03022307;
  EXPECT_THAT(refusal(swapped), HasSubstr("word 0: the module has the other byte order"));

  auto empty = words;
  empty[5] &= 0xffffu;
  EXPECT_THAT(refusal(empty), HasSubstr("word 5: OpCapability has a length of 0 words"));

  auto cut = words;
  cut.pop_back();
  EXPECT_THAT(refusal(cut), HasSubstr("OpReturn"));

  auto bound = words;
  bound[3] = 5;
  EXPECT_THAT(refusal(bound), HasSubstr("outside the bound 5"));

  auto huge = words;
  huge[3] = 0xffffffff;
  EXPECT_THAT(refusal(huge), HasSubstr("word 3: id bound 4294967295"));
}

TEST(Module, RefusesAnIdThatIsDefinedTwice) {
  std::vector<std::uint32_t> words = testing::module_named("twice.asm");
  const Module module = Module::parse(words);
  const Instruction& last = module.globals().back();
  words.insert(words.begin() + static_cast<std::ptrdiff_t>(last.offset()), last.words().begin(),
               last.words().end());
  EXPECT_THAT(refusal(words),
              HasSubstr("again; it was defined at word " + std::to_string(last.offset())));
}

TEST(Module, PassesOpcodesItDoesNotKnow) {
  std::vector<std::uint32_t> words = testing::module_named("twice.asm");
  const std::uint32_t unknown = 0xfff0u;
  words.insert(words.end() - 2, {3u << 16 | unknown, 1u, 2u});
  const Module module = Module::parse(words);
  EXPECT_THAT(module.unknown_opcodes(), ::testing::ElementsAre(unknown));
  EXPECT_EQ(module.words(), words);
}

}  // namespace
}  // namespace a2rt::spirv
