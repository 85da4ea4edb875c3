#include "spirv/instrument.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "spirv/call_graph.h"
#include "spirv/weights.h"
#include "test_modules.h"

namespace a2rt::spirv {
namespace {

using capture::RecordKind;
using capture::Stage;
using spv::Op;
using testing::all_modules;
using ::testing::HasSubstr;
using testing::module_named;

InstrumentResult everything(const std::string& name) {
  InstrumentOptions options;
  options.header_address = 0x500000000040;
  return instrument(module_named(name), options);
}

std::optional<std::uint32_t> constant(const Module& module, Id id) {
  const Instruction* const defined = module.definition(id);
  return defined != nullptr && defined->op() == Op::OpConstant ? std::optional(defined->operand(0))
                                                               : std::nullopt;
}

bool is_private_load(const Module& module, Id id) {
  const Instruction* const load = module.definition(id);
  if (load == nullptr || load->op() != Op::OpLoad) {
    return false;
  }
  const Instruction* const variable = module.definition(load->operand(0));
  return variable != nullptr && variable->op() == Op::OpVariable &&
         variable->operand(0) == static_cast<std::uint32_t>(spv::StorageClass::Private);
}

// Whether the function writes a record: its first word is context.tag | kind.
bool appends(const Module& module, const Function& function) {
  return std::ranges::any_of(function.code, [&](const Instruction& instruction) {
    if (instruction.op() != Op::OpBitwiseOr) {
      return false;
    }
    const Instruction* const tag = module.definition(instruction.operand(0));
    return tag != nullptr && tag->op() == Op::OpCompositeExtract && tag->operand(1) == 0 &&
           is_private_load(module, tag->operand(0));
  });
}

// How often each kind of record is written in the code: the first argument of each call of a
// function that appends.
std::map<RecordKind, int> record_sites(const std::vector<std::uint32_t>& words) {
  const Module module = Module::parse(words);
  std::set<Id> writers;
  for (const Function& function : module.functions()) {
    if (appends(module, function)) {
      writers.insert(function.id);
    }
  }
  std::map<RecordKind, int> found;
  for (const Function& function : module.functions()) {
    for (const Instruction& instruction : function.code) {
      if (instruction.op() == Op::OpFunctionCall && writers.contains(instruction.operand(0))) {
        ++found[static_cast<RecordKind>(constant(module, instruction.operand(1)).value_or(0))];
      }
    }
  }
  return found;
}

using Sites = std::map<RecordKind, int>;

TEST(Instrument, EachStageWritesItsRecords) {
  using enum RecordKind;
  const std::map<std::string, Sites> expected{
      {"raygen.rgen", {{kRay, 1}, {kEnd, 1}}},
      {"called_trace.rgen", {{kRay, 1}, {kEnd, 1}}},
      {"plain.rchit", {{kHit, 1}, {kEnd, 1}}},
      {"recursive.rchit", {{kHit, 1}, {kRay, 1}, {kEnd, 1}}},
      {"sky.rmiss", {{kMiss, 1}, {kEnd, 1}}},
      {"alpha.rahit", {{kAnyHit, 3}, {kEnd, 3}}},
      {"sphere.rint", {{kReport, 2}, {kSegment, 2}, {kEnd, 1}}},
      {"tint.rcall", {{kSegment, 1}, {kEnd, 1}}},
      {"callables.rgen", {{kSegment, 1}, {kEnd, 1}}},
      {"query.comp", {{kRay, 1}, {kQueryStep, 1}, {kQueryVerdict, 3}, {kEnd, 1}}},
      {"query_sized.comp", {{kRay, 1}, {kQueryStep, 1}, {kEnd, 1}}},
      // One function for the computed index, one for the constant.
      {"query_array.comp", {{kRay, 1}, {kQueryStep, 2}, {kEnd, 1}}},
      // Once at the end and once before the discard.
      {"query.frag", {{kRay, 1}, {kQueryStep, 1}, {kEnd, 2}}},
  };
  for (const auto& [shader, sites] : expected) {
    for (const std::string variant : {".v12", ".v13", ".spv14", ".debug"}) {
      EXPECT_EQ(record_sites(everything(shader + variant).words), sites) << shader << variant;
    }
  }
}

TEST(Instrument, FragmentTestsStayEarlyWhereNobodyCanTell) {
  const auto is_early = [](const std::vector<std::uint32_t>& words) {
    return std::ranges::any_of(Module::parse(words).globals(), [](const Instruction& i) {
      constexpr auto kEarly = static_cast<std::uint32_t>(spv::ExecutionMode::EarlyFragmentTests);
      return i.op() == Op::OpExecutionMode && i.operand(1) == kEarly;
    });
  };
  const auto tests = [](const InstrumentResult& result) {
    return result.analysis.entry_points.at(0).fragment_tests;
  };
  const InstrumentResult color = everything("color.frag.v12");
  EXPECT_TRUE(is_early(color.words));
  EXPECT_EQ(tests(color), FragmentTests::kMadeEarly);
  InstrumentOptions late;
  late.early_tests = false;
  EXPECT_FALSE(is_early(instrument(module_named("color.frag.v12"), late).words));
  const InstrumentResult discards = everything("query.frag.v12");
  EXPECT_FALSE(is_early(discards.words));
  EXPECT_EQ(tests(discards), FragmentTests::kMadeLate);
  const InstrumentResult deep = everything("deep.frag.v12");
  EXPECT_FALSE(is_early(deep.words));
  EXPECT_EQ(tests(deep), FragmentTests::kAsBefore);
}

TEST(Instrument, OptionsRemoveWhatTheyName) {
  InstrumentOptions options;
  options.counters = false;
  EXPECT_EQ(
      record_sites(instrument(module_named("query.comp.v12"), options).words),
      (Sites{{RecordKind::kRay, 1}, {RecordKind::kQueryStep, 1}, {RecordKind::kQueryVerdict, 3}}));
  options.candidates = false;
  options.results = false;
  EXPECT_EQ(record_sites(instrument(module_named("query.comp.v12"), options).words),
            (Sites{{RecordKind::kRay, 1}}));
  options.site_limit = 0;
  const InstrumentResult limited = instrument(module_named("query.comp.v12"), options);
  EXPECT_EQ(record_sites(limited.words), Sites{});
  EXPECT_FALSE(limited.analysis.sites.at(0).instrumented);
}

TEST(Instrument, WithEverythingOffAModuleIsUnchanged) {
  const InstrumentOptions off{
      .rays = false, .results = false, .candidates = false, .counters = false, .verdicts = false};
  for (const auto& module : all_modules()) {
    const InstrumentResult result = instrument(module.words, off);
    EXPECT_FALSE(result.instrumented);
    EXPECT_EQ(result.words, module.words) << module.name;
  }
}

TEST(Instrument, ModulesWithoutRaysAreUnchanged) {
  for (const std::string name : {"plain.comp.v12", "query.vert.v12", "weights.asm"}) {
    const InstrumentResult result = everything(name);
    EXPECT_FALSE(result.instrumented) << name;
    EXPECT_EQ(result.shader_count, 0u);
    EXPECT_EQ(result.words, module_named(name)) << name;
  }
  EXPECT_THAT(everything("query.vert.v12").analysis.warnings.at(0),
              HasSubstr("ray queries of this stage are not recorded"));
}

TEST(Instrument, EntryPointsAreNumberedFromTheFirstIndex) {
  InstrumentOptions options;
  options.first_shader_index = 40;
  const InstrumentResult result = instrument(module_named("linked.v12"), options);
  EXPECT_EQ(result.shader_count, 5u);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(result.analysis.entry_points[i].instrumented);
    EXPECT_EQ(result.analysis.entry_points[i].shader, 40 + i);
  }
  options.first_shader_index = 0xfffc;
  EXPECT_THROW(instrument(module_named("linked.v12"), options), SpirvError);
}

// Tags (stage << 8 | shader << 16) that the wrappers of a module put into the context.
std::map<std::string, std::uint32_t> entry_tags(const std::vector<std::uint32_t>& words) {
  const Module module = Module::parse(words);
  std::map<std::string, std::uint32_t> tags;
  for (const EntryDeclaration& entry : entry_declarations(module)) {
    for (const Instruction& instruction : module.function(entry.function)->code) {
      if (instruction.op() == Op::OpStore && !tags.contains(entry.name)) {
        const Instruction* const value = module.definition(instruction.operand(1));
        if (value != nullptr && value->op() == Op::OpCompositeConstruct) {
          tags[entry.name] = constant(module, value->operand(0)).value_or(UINT32_MAX);
        }
      }
    }
  }
  return tags;
}

TEST(Instrument, AFunctionSharedByTwoStagesRecordsTheShaderThatRuns) {
  const auto tag = [](Stage stage, std::uint32_t shader) {
    return static_cast<std::uint32_t>(stage) << 8 | shader << 16;
  };
  const InstrumentResult shared = everything("shared.asm");
  const std::map<std::string, std::uint32_t> expected{{"gen", tag(Stage::kRayGeneration, 0)},
                                                      {"hit", tag(Stage::kClosestHit, 1)}};
  EXPECT_EQ(entry_tags(shared.words), expected);
  EXPECT_EQ(record_sites(shared.words)[RecordKind::kRay], 1);

  const std::map<std::string, std::uint32_t> twice{{"as_raygen", tag(Stage::kRayGeneration, 0)},
                                                   {"as_miss", tag(Stage::kMiss, 1)}};
  EXPECT_EQ(entry_tags(everything("twice.asm").words), twice);
}

TEST(Instrument, AnEntryPointThatCannotRecordIsSilentInASharedFunction) {
  const InstrumentResult result = everything("silent.asm");
  EXPECT_FALSE(result.analysis.entry_points.at(0).instrumented);
  EXPECT_TRUE(result.analysis.entry_points.at(1).instrumented);
  EXPECT_EQ(result.shader_count, 1u);
  const std::map<std::string, std::uint32_t> expected{
      {"vertex", static_cast<std::uint32_t>(Stage::kOther) << 8},
      {"fragment", static_cast<std::uint32_t>(Stage::kFragment) << 8}};
  EXPECT_EQ(entry_tags(result.words), expected);
  // The third word of the context switches recording on.
  const Module module = Module::parse(result.words);
  for (const EntryDeclaration& entry : entry_declarations(module)) {
    for (const Instruction& i : module.function(entry.function)->code) {
      if (i.op() == Op::OpStore) {
        const Instruction* const context = module.definition(i.operand(1));
        EXPECT_EQ(constant(module, context->operand(2)), entry.name == "fragment" ? 1u : 0u);
        break;
      }
    }
  }
}

TEST(Instrument, BuiltinsAreAddedOnlyWhereTheyAreUsed) {
  const Module module = Module::parse(everything("linked.v12").words);
  std::map<Id, std::uint32_t> builtins;
  for (const Instruction& i : module.globals()) {
    if (i.op() == Op::OpDecorate &&
        i.operand(1) == static_cast<std::uint32_t>(spv::Decoration::BuiltIn)) {
      builtins[i.operand(0)] = i.operand(2);
    }
  }
  for (const EntryDeclaration& entry : entry_declarations(module)) {
    std::multiset<std::uint32_t> listed;
    for (const Id variable : entry.interface) {
      if (builtins.contains(variable)) {
        listed.insert(builtins[variable]);
      }
    }
    for (const std::uint32_t builtin : listed) {
      EXPECT_EQ(listed.count(builtin), 1u) << entry.name << " builtin " << builtin;
    }
    const bool is_query = entry.name == "query";
    EXPECT_EQ(listed.count(static_cast<std::uint32_t>(spv::BuiltIn::LaunchIdKHR)),
              is_query ? 0 : 1);
    EXPECT_EQ(listed.count(static_cast<std::uint32_t>(spv::BuiltIn::NumWorkgroups)),
              is_query ? 1 : 0);
    const bool has_hit = entry.name == "hit" || entry.name == "any";
    EXPECT_EQ(listed.count(static_cast<std::uint32_t>(spv::BuiltIn::HitKindKHR)), has_hit ? 1 : 0);
  }
}

TEST(Instrument, ModesFollowTheEntryPoint) {
  const Module module = Module::parse(everything("shared.asm").words);
  std::map<std::string, Id> functions;
  for (const EntryDeclaration& entry : entry_declarations(module)) {
    functions[entry.name] = entry.function;
  }
  int modes = 0;
  for (const Instruction& i : module.globals()) {
    if (i.op() == Op::OpExecutionMode) {
      ++modes;
      EXPECT_EQ(i.operand(0), functions["plain"]);
    }
  }
  EXPECT_EQ(modes, 1);
}

// What the inserted code adds to the counters, over all blocks.
Weights added_weights(const std::vector<std::uint32_t>& words) {
  const Module module = Module::parse(words);
  // The wrapper clears both halves, the lower one first.
  std::vector<Id> halves;
  for (const Instruction& i : module.function(entry_declarations(module)[0].function)->code) {
    if (i.op() == Op::OpStore && module.definition(i.operand(1))->op() == Op::OpConstantComposite) {
      halves.push_back(i.operand(0));
    }
  }
  Weights sum;
  for (const Function& function : module.functions()) {
    for (const Instruction& i : function.code) {
      if (i.op() != Op::OpIAdd || !is_private_load(module, i.operand(0))) {
        continue;
      }
      const Instruction* const amount = module.definition(i.operand(1));
      const Id variable = module.definition(i.operand(0))->operand(0);
      if (amount->op() != Op::OpConstantComposite || amount->operand_count() != 4) {
        continue;
      }
      const std::size_t first = variable == halves.at(0) ? 0 : 4;
      for (std::size_t c = 0; c < 4; ++c) {
        sum.count[first + c] += *constant(module, amount->operand(c));
      }
    }
  }
  return sum;
}

TEST(Instrument, BlocksAddExactlyTheWeightsOfTheirInstructions) {
  for (const auto& test : all_modules()) {
    if (!test.name.ends_with(".v13") && !test.name.ends_with(".debug")) {
      continue;
    }
    const InstrumentResult result = instrument(test.words, {});
    if (!result.instrumented) {
      continue;
    }
    const Module module = Module::parse(test.words);
    const WeightTable table(module);
    Weights expected;
    for (const Function& function : module.functions()) {
      for (const Instruction& instruction : function.code) {
        expected += table.weigh(instruction);
      }
    }
    EXPECT_EQ(added_weights(result.words).count, expected.count) << test.name;
  }
}

TEST(Instrument, CountersAreRaisedBeforeTheRecordThatCarriesThem) {
  // called_trace.rgen: the block that calls twice() must raise its counters before the call,
  // because the callee flushes them.
  const Module module = Module::parse(everything("called_trace.rgen.v12").words);
  const CallGraph calls(module);
  for (const Function& function : module.functions()) {
    bool raised = false;
    for (const Instruction& i : function.code) {
      if (i.op() == Op::OpLabel) {
        raised = false;
      }
      raised |= i.op() == Op::OpStore && module.type_of(i.operand(0)) != 0 &&
                module.definition(i.operand(0))->op() == Op::OpVariable &&
                module.definition(i.operand(0))->operand(0) ==
                    static_cast<std::uint32_t>(spv::StorageClass::Private);
      if (i.op() == Op::OpFunctionCall && calls.may_flush(i.operand(0))) {
        EXPECT_TRUE(raised) << "call at word " << i.offset();
      }
    }
  }
}

TEST(Instrument, HeaderAddressIsBakedInLowWordFirst) {
  InstrumentOptions options;
  options.header_address = 0x123456789abcdef0;
  const Module module = Module::parse(instrument(module_named("plain.rchit.v12"), options).words);
  bool found = false;
  for (const Instruction& i : module.globals()) {
    found |= i.op() == Op::OpConstantComposite && i.operand_count() == 2 &&
             constant(module, i.operand(0)) == 0x9abcdef0u &&
             constant(module, i.operand(1)) == 0x12345678u;
  }
  EXPECT_TRUE(found);
}

TEST(Instrument, NvRayTracingModulesPassThroughWithAWarning) {
  auto words = module_named("twice.asm");
  const Module module = Module::parse(words);
  for (const Instruction& i : module.globals()) {
    if (i.op() == Op::OpCapability &&
        i.operand(0) == static_cast<std::uint32_t>(spv::Capability::RayTracingKHR)) {
      words[i.offset() + 1] = static_cast<std::uint32_t>(spv::Capability::RayTracingNV);
    }
  }
  const InstrumentResult result = instrument(words, {});
  EXPECT_FALSE(result.instrumented);
  EXPECT_EQ(result.words, words);
  EXPECT_THAT(result.analysis.warnings.at(0), HasSubstr("SPV_NV_ray_tracing"));
}

}  // namespace
}  // namespace a2rt::spirv
