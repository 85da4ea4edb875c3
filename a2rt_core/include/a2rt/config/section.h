// Typed view of one TOML table. Every key that is not read is an error naming file:line:column, so
// a misspelt parameter costs seconds, not a sweep.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace a2rt::config {

// What was asked of a parameter; `describe` lists them so that `--help` and docs cannot go stale.
struct ParameterDoc {
  std::string key, unit, sentence, value;
};

// One TOML table. Copies share the record of which keys were read.
class Section {
 public:
  // Reads a file, then applies overrides of the form "key=value" or "table.key=value" (TOML
  // values). Throws UserError naming file:line:column for syntax errors and for keys given twice.
  static Section from_file(const std::filesystem::path& file,
                           const std::vector<std::string>& overrides = {});
  // The same from text; `name` stands for the file in messages.
  static Section from_text(std::string_view text, const std::string& name,
                           const std::vector<std::string>& overrides = {});

  // Each returns the value of `key`, or `fallback` if it is absent; the overloads without fallback
  // require it. Throws UserError (file:line:column, what was found, what is allowed) if the type is
  // wrong or the value is outside [least, most].
  std::int64_t integer(const std::string& key, std::int64_t fallback, std::int64_t least,
                       std::int64_t most, const std::string& unit,
                       const std::string& sentence) const;
  double number(const std::string& key, double fallback, double least, double most,
                const std::string& unit, const std::string& sentence) const;
  bool boolean(const std::string& key, bool fallback, const std::string& sentence) const;
  std::string text(const std::string& key, const std::string& fallback,
                   const std::string& sentence) const;
  // One of `allowed`.
  std::string choice(const std::string& key, const std::string& fallback,
                     const std::vector<std::string>& allowed, const std::string& sentence) const;
  std::vector<double> numbers(const std::string& key, const std::vector<double>& fallback,
                              const std::string& unit, const std::string& sentence) const;
  std::vector<std::string> texts(const std::string& key, const std::vector<std::string>& fallback,
                                 const std::string& sentence) const;
  // Sub-table; empty if absent.
  Section table(const std::string& key) const;
  bool has(const std::string& key) const;

  // Throws UserError for the first key, here or in any sub-table, that nobody read.
  void reject_unknown_keys() const;
  // All parameters read so far, with the value in effect, in order of first reading. Dotted keys.
  std::vector<ParameterDoc> describe() const;

 private:
  struct State;
  explicit Section(std::shared_ptr<State> state, std::string path);
  std::shared_ptr<State> state_;
  std::string path_;
};

}  // namespace a2rt::config
