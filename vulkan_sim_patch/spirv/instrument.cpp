#include "spirv/instrument.h"

#include <algorithm>

#include "spirv/analysis.h"
#include "spirv/editor.h"
#include "spirv/entry_wrapper.h"

namespace a2rt::spirv {
namespace {

// SPIR-V 1.4 and later list every global an entry point uses, earlier ones only inputs and outputs.
constexpr std::uint32_t kAllGlobalsListed = 0x00010400;
constexpr std::uint32_t kMaxShaders = 0x10000;  // 16 bits of a record's first word

bool has_mode(const Module& module, Id function, spv::ExecutionMode mode) {
  return std::ranges::any_of(module.globals(), [&](const Instruction& i) {
    return i.op() == spv::Op::OpExecutionMode && i.operand(0) == function &&
           i.operand(1) == static_cast<std::uint32_t>(mode);
  });
}

bool writes_sample_mask(const Module& module, const EntryDeclaration& entry) {
  return std::ranges::any_of(module.globals(), [&](const Instruction& i) {
    const bool is_mask = i.op() == spv::Op::OpDecorate && i.operand_count() >= 3 &&
                         i.operand(1) == static_cast<std::uint32_t>(spv::Decoration::BuiltIn) &&
                         i.operand(2) == static_cast<std::uint32_t>(spv::BuiltIn::SampleMask);
    const Instruction* const variable = is_mask ? module.definition(i.operand(0)) : nullptr;
    return variable != nullptr && variable->op() == spv::Op::OpVariable &&
           variable->operand(0) == static_cast<std::uint32_t>(spv::StorageClass::Output) &&
           std::ranges::find(entry.interface, i.operand(0)) != entry.interface.end();
  });
}

// What becomes of depth and stencil tests that a driver does before the program's own shader.
FragmentTests choose_tests(const Module& module, const EntryDeclaration& entry,
                           const RayFeatures& features, bool may_be_early) {
  using spv::ExecutionMode;
  const bool decided = has_mode(module, entry.function, ExecutionMode::EarlyFragmentTests) ||
                       has_mode(module, entry.function, ExecutionMode::DepthReplacing) ||
                       has_mode(module, entry.function, ExecutionMode::StencilRefReplacingEXT) ||
                       features.writes_memory;
  if (stage_of(entry.model) != capture::Stage::kFragment || decided) {
    return FragmentTests::kAsBefore;
  }
  const bool color_only =
      !features.discards && !features.is_ordered && !writes_sample_mask(module, entry);
  return color_only && may_be_early ? FragmentTests::kMadeEarly : FragmentTests::kMadeLate;
}

// Picks the entry points to instrument and numbers them.
std::uint32_t choose(Analysis& analysis, const Module& module, const CallGraph& calls,
                     const std::vector<EntryDeclaration>& declarations,
                     const InstrumentOptions& options) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < declarations.size(); ++i) {
    EntryPoint& entry = analysis.entry_points[i];
    const RayFeatures features = calls.features(calls.reached(declarations[i].function));
    entry.instrumented = can_record(entry, features);
    if (entry.instrumented) {
      entry.shader = options.first_shader_index + count++;
      entry.fragment_tests = choose_tests(module, declarations[i], features, options.early_tests);
    } else if (features.query_initializes) {
      analysis.warnings.push_back("entry point '" + entry.name +
                                  "': ray queries of this stage are not recorded");
    }
  }
  if (count > 0 && (count > kMaxShaders || options.first_shader_index > kMaxShaders - count)) {
    throw SpirvError(0, "shader index " + std::to_string(options.first_shader_index + count - 1) +
                            " does not fit the 16 bits that records have for it");
  }
  for (TraceSite& site : analysis.sites) {
    site.instrumented =
        site.site < options.site_limit &&
        std::ranges::any_of(analysis.entry_points, [&](const EntryPoint& entry) {
          return entry.instrumented && std::ranges::binary_search(entry.sites, site.site);
        });
  }
  return count;
}

class Rewriter {
 public:
  Rewriter(const Module& module, const CallGraph& calls, const InstrumentOptions& options)
      : module_(module),
        calls_(calls),
        types_(module),
        appends_(types_),
        writer_(types_, appends_, options.header_address),
        counters_(types_, options.counters),
        hits_(types_),
        weights_(module),
        queries_(types_, writer_),
        builtins_(types_),
        editor_(module, types_),
        shared_{options, calls, writer_, counters_, hits_, weights_, queries_} {}

  std::vector<std::uint32_t> run(const Analysis& analysis,
                                 const std::vector<EntryDeclaration>& declarations) {
    editor_.use_device_addresses();
    std::set<std::size_t> edited;
    for (std::size_t i = 0; i < declarations.size(); ++i) {
      if (analysis.entry_points[i].instrumented) {
        edited.merge(calls_.reached(declarations[i].function));
      }
    }
    rewrite_functions(edited);
    for (std::size_t i = 0; i < declarations.size(); ++i) {
      const EntryDeclaration& declaration = declarations[i];
      if (analysis.entry_points[i].instrumented) {
        EntryWrapper wrapper =
            wrap_entry(declaration, shared_, builtins_, analysis.entry_points[i].shader);
        editor_.redirect(declaration, wrapper.function, variables(std::move(wrapper.inputs)));
        if (analysis.entry_points[i].fragment_tests == FragmentTests::kMadeEarly) {
          editor_.add_mode(wrapper.function, spv::ExecutionMode::EarlyFragmentTests);
        }
        editor_.add_function(std::move(wrapper.code));
      } else {
        adapt(declaration, edited);
      }
    }
    for (std::vector<Instruction>& function : queries_.take_functions()) {
      editor_.add_function(std::move(function));
    }
    for (std::vector<Instruction>& function : appends_.take()) {
      editor_.add_function(std::move(function));
    }
    return editor_.words();
  }

 private:
  void rewrite_functions(const std::set<std::size_t>& edited) {
    std::uint32_t site = 0;
    for (std::size_t f = 0; f < module_.functions().size(); ++f) {
      const Function& function = module_.functions()[f];
      if (edited.contains(f)) {
        std::vector<Instruction> code = FunctionPass(shared_, types_, site).rewrite(function);
        if (std::ranges::any_of(code, [&](const Instruction& i) { return records(i); })) {
          recording_.insert(f);
        }
        editor_.replace_function(function.id, std::move(code));
      }
      site += static_cast<std::uint32_t>(std::ranges::count_if(function.code, is_trace_site));
    }
  }

  // True for inserted instructions that only record sites have.
  bool records(const Instruction& instruction) const {
    return (instruction.op() == spv::Op::OpLoad &&
            instruction.operand(0) == writer_.variables().front()) ||
           (instruction.op() == spv::Op::OpFunctionCall &&
            instruction.operand(0) >= module_.bound());
  }

  // An entry point that is not instrumented may call functions that now count or record.
  void adapt(const EntryDeclaration& entry, const std::set<std::size_t>& edited) {
    const auto reaches = [&](const std::set<std::size_t>& functions) {
      return std::ranges::any_of(calls_.reached(entry.function),
                                 [&](std::size_t f) { return functions.contains(f); });
    };
    if (reaches(recording_)) {
      EntryWrapper wrapper = wrap_silent_entry(entry, shared_, types_);
      editor_.redirect(entry, wrapper.function, variables({}));
      editor_.add_function(std::move(wrapper.code));
    } else if (reaches(edited)) {
      editor_.redirect(entry, entry.function, variables({}));
    }
  }

  std::vector<Id> variables(std::vector<Id> inputs) {
    if (module_.version() >= kAllGlobalsListed) {
      const auto add = [&](const std::vector<Id>& more) {
        inputs.insert(inputs.end(), more.begin(), more.end());
      };
      add(writer_.variables());
      add(counters_.variables());
      add(hits_.variables());
      add(queries_.ordinals().variables());
    }
    return inputs;
  }

  const Module& module_;
  const CallGraph& calls_;
  std::set<std::size_t> recording_;  // functions with record sites
  TypePool types_;
  AppendFunctions appends_;
  RecordWriter writer_;
  Counters counters_;
  HitData hits_;
  WeightTable weights_;
  QueryRecords queries_;
  BuiltinPool builtins_;
  ModuleEditor editor_;
  Instrumentation shared_;
};

}  // namespace

InstrumentResult instrument(std::span<const std::uint32_t> words,
                            const InstrumentOptions& options) {
  const Module module = Module::parse(words);
  const CallGraph calls(module);
  InstrumentResult result;
  result.analysis = analyse_module(module, calls, std::nullopt);
  result.words.assign(words.begin(), words.end());
  if (!result.analysis.has_rays()) {
    return result;
  }
  if (const std::string reason = reason_to_pass_through(module); !reason.empty()) {
    result.analysis.warnings.push_back("the module is passed through: " + reason);
    return result;
  }
  if (!options.rays && !options.results && !options.candidates && !options.counters &&
      !options.verdicts) {
    return result;
  }
  const std::vector<EntryDeclaration> declarations = entry_declarations(module);
  result.shader_count = choose(result.analysis, module, calls, declarations, options);
  if (result.shader_count == 0) {
    return result;
  }
  result.words = Rewriter(module, calls, options).run(result.analysis, declarations);
  result.instrumented = true;
  return result;
}

}  // namespace a2rt::spirv
