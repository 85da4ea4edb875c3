// Options of a command-line program. The option library behind it takes longer to compile than most
// commands, so only this room's .cpp sees it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace a2rt::cli {

// What a value must satisfy; the message of the usage error says it.
struct Check {
  enum class Kind { kRange, kPositive, kExistingFile, kOneOf };
  Kind kind;
  double least = 0, most = 0;
  std::vector<std::string> names;
};

inline Check in_range(double least, double most) { return {Check::Kind::kRange, least, most, {}}; }
inline Check positive() { return {Check::Kind::kPositive, 0, 0, {}}; }
inline Check existing_file() { return {Check::Kind::kExistingFile, 0, 0, {}}; }
inline Check one_of(std::vector<std::string> names) {
  return {Check::Kind::kOneOf, 0, 0, std::move(names)};
}

// One option that was added; every call returns the option, so that they can be chained.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option& required();
  Option& check(const Check& check);
  // Values of a list may also stand in one word, separated by `c`.
  Option& delimiter(char c);
  // A list takes one value each time that the option is named, so a positional may follow it.
  Option& one_value_each();

 private:
  CLI::Option* option_;
};

// The options of one program or one of its subcommands. Names are written "-o,--output", or "file"
// for a positional. Targets must outlive the parsing.
class Options {
 public:
  explicit Options(CLI::App* app) : app_(app) {}

  Option add(const std::string& names, std::string& target, const std::string& sentence);
  Option add(const std::string& names, int& target, const std::string& sentence);
  Option add(const std::string& names, std::uint32_t& target, const std::string& sentence);
  Option add(const std::string& names, std::uint64_t& target, const std::string& sentence);
  Option add(const std::string& names, float& target, const std::string& sentence);
  Option add(const std::string& names, double& target, const std::string& sentence);
  Option add(const std::string& names, std::vector<std::string>& target,
             const std::string& sentence);
  Option add(const std::string& names, std::vector<int>& target, const std::string& sentence);
  Option add(const std::string& names, std::vector<std::uint32_t>& target,
             const std::string& sentence);
  Option add(const std::string& names, std::filesystem::path& target, const std::string& sentence);
  Option add(const std::string& names, std::optional<double>& target, const std::string& sentence);
  Option add(const std::string& names, std::optional<std::uint32_t>& target,
             const std::string& sentence);
  Option flag(const std::string& names, bool& target, const std::string& sentence);

 private:
  CLI::App* app_;
};

// A program: parses the words it was called with. `--help` and usage errors are printed by it.
class Program {
 public:
  Program(const std::string& sentence, const std::string& name);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  Options options();
  void footer(const std::string& text);
  // From then on one subcommand must be named.
  Options add_subcommand(const std::string& name, const std::string& sentence,
                         const std::string& footer);
  // Nothing where the program goes on; else the status it ends with: 0 after --help, or
  // `usage_status` for a usage error.
  std::optional<int> parse(int argc, char** argv, int usage_status);
  // Name of the subcommand that was named; empty where there are none.
  std::string subcommand() const;

 private:
  struct Body;
  std::unique_ptr<Body> body_;
};

}  // namespace a2rt::cli
