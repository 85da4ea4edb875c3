// a2rt-spirv: shows what a SPIR-V module does with rays, or instruments it, for people who look
// into a bad rewrite.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "spirv/instrument.h"

namespace {

using namespace a2rt::spirv;

std::vector<std::uint32_t> read_words(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) {
    throw std::runtime_error(path + ": cannot be opened");
  }
  const std::streamoff bytes = file.tellg();
  if (bytes % 4 != 0) {
    throw std::runtime_error(path + ": " + std::to_string(bytes) +
                             " bytes are not a whole number of SPIR-V words");
  }
  std::vector<std::uint32_t> words(static_cast<std::size_t>(bytes / 4));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(words.data()), bytes);
  return words;
}

void write_words(const std::string& path, const std::vector<std::uint32_t>& words) {
  const std::string temporary = path + ".tmp";
  {
    std::ofstream file(temporary, std::ios::binary);
    file.write(reinterpret_cast<const char*>(words.data()),
               static_cast<std::streamsize>(words.size() * 4));
    if (!file.flush()) {
      std::remove(temporary.c_str());
      throw std::runtime_error(path + ": cannot be written");
    }
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    std::remove(temporary.c_str());
    throw std::runtime_error(path + ": cannot be replaced");
  }
}

const char* stage_name(a2rt::capture::Stage stage) {
  constexpr const char* kNames[] = {"ray generation", "intersection", "any-hit",
                                    "closest-hit",    "miss",         "callable",
                                    "compute",        "fragment",     "other"};
  return kNames[static_cast<std::size_t>(stage)];
}

std::string text(const StructureSource& source) {
  switch (source.kind) {
    case StructureSource::Kind::kDescriptor: {
      std::string place =
          "set " + std::to_string(source.set) + " binding " + std::to_string(source.binding);
      if (source.is_array) {
        place += "[" + (source.element ? std::to_string(*source.element) : "?") + "]";
      }
      return place;
    }
    case StructureSource::Kind::kAddress:
      return "address";
    case StructureSource::Kind::kUnknown:
      break;
  }
  return "unknown";
}

std::string text(const std::optional<std::uint32_t>& value) {
  char hex[16];
  std::snprintf(hex, sizeof hex, "0x%x", value.value_or(0));
  return value ? hex : "not constant";
}

void print(const Analysis& analysis) {
  std::cout << "SPIR-V " << (analysis.version >> 16 & 0xff) << '.' << (analysis.version >> 8 & 0xff)
            << '\n';
  for (const EntryPoint& entry : analysis.entry_points) {
    std::cout << "entry point " << entry.name << ": " << stage_name(entry.stage);
    if (entry.instrumented) {
      std::cout << ", instrumented as shader " << entry.shader;
    }
    std::cout << (entry.uses_ray_query ? ", ray query" : "")
              << (entry.executes_callable ? ", executes callables" : "")
              << (entry.reports_intersection ? ", reports intersections" : "")
              << (entry.ignores_intersection ? ", may ignore" : "")
              << (entry.terminates_ray ? ", may terminate" : "") << "; trace sites:";
    for (const std::uint32_t site : entry.sites) {
      std::cout << ' ' << site;
    }
    std::cout << (entry.sites.empty() ? " none\n" : "\n");
  }
  for (const TraceSite& site : analysis.sites) {
    std::cout << "site " << site.site << ": " << (site.is_query ? "ray query" : "trace")
              << ", structure " << text(site.structure) << ", flags " << text(site.ray_flags)
              << ", cull mask " << text(site.cull_mask) << '\n';
  }
  for (const std::string& warning : analysis.warnings) {
    std::cout << "warning: " << warning << '\n';
  }
}

struct Arguments {
  std::string input;
  std::string output;
  InstrumentOptions options;
  bool no_rays = false, no_results = false, no_candidates = false;
  bool no_counters = false, no_verdicts = false;
};

void run(Arguments& a) {
  const std::vector<std::uint32_t> words = read_words(a.input);
  if (a.output.empty()) {
    print(analyse(words));
    return;
  }
  a.options.rays = !a.no_rays;
  a.options.results = !a.no_results;
  a.options.candidates = !a.no_candidates;
  a.options.counters = !a.no_counters;
  a.options.verdicts = !a.no_verdicts;
  const InstrumentResult result = instrument(words, a.options);
  print(result.analysis);
  write_words(a.output, result.words);
  std::cout << a.output << ": " << result.words.size() << " words, "
            << (result.instrumented ? "instrumented" : "unchanged") << " (was " << words.size()
            << ")\n";
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  CLI::App app(
      "Show what a SPIR-V module does with rays; with -o, also instrument it.\n"
      "  a2rt-spirv shader.spv\n"
      "  a2rt-spirv shader.spv -o out.spv --header 0x500000000000\n"
      "  a2rt-spirv shader.spv -o out.spv --no-counters --site-limit 3   (bisecting)",
      "a2rt-spirv");
  app.add_option("input", a.input, "SPIR-V module (.spv)")->required();
  app.add_option("-o,--output", a.output, "where the instrumented module goes");
  app.add_option("--header", a.options.header_address, "device address of the record header");
  app.add_option("--first-shader", a.options.first_shader_index, "index of the first entry point");
  app.add_option("--site-limit", a.options.site_limit, "leave trace sites from this one on alone");
  app.add_flag("--no-rays", a.no_rays, "no kRay records");
  app.add_flag("--no-results", a.no_results, "no hit, miss and query step records");
  app.add_flag("--no-candidates", a.no_candidates, "no any-hit, report and query verdict records");
  app.add_flag("--no-counters", a.no_counters, "no instruction counters");
  app.add_flag("--no-verdicts", a.no_verdicts, "no verdict lookup");
  CLI11_PARSE(app, argc, argv);
  try {
    run(a);
  } catch (const SpirvError& error) {
    std::cerr << "a2rt-spirv: " << a.input << ": " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "a2rt-spirv: " << error.what() << '\n';
    return 2;
  }
  return 0;
}
