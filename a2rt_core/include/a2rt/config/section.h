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
  // Reads a file, then applies overrides of the form "key=value" or "table.key=value" (TOML values;
  // a bare word stands for a string). `inherits = "other.toml"` in the file, relative to it, names
  // the file whose values hold where this one is silent. Throws UserError naming file:line:column
  // for syntax errors, keys given twice and files that inherit from themselves.
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
  // The same for parameters that have no default: an absent key is an error naming the file.
  std::int64_t integer(const std::string& key, std::int64_t least, std::int64_t most,
                       const std::string& unit, const std::string& sentence) const;
  double number(const std::string& key, double least, double most, const std::string& unit,
                const std::string& sentence) const;
  std::string text(const std::string& key, const std::string& sentence) const;
  std::string choice(const std::string& key, const std::vector<std::string>& allowed,
                     const std::string& sentence) const;
  std::vector<double> numbers(const std::string& key, const std::string& unit,
                              const std::string& sentence) const;
  std::vector<std::string> texts(const std::string& key, const std::string& sentence) const;

  // Sub-table; empty if absent.
  Section table(const std::string& key) const;
  // Elements of an array of tables ([[key]]); none if absent.
  std::vector<Section> tables(const std::string& key) const;
  // Names of the keys present here, in the order of the file. Reading them does not count as use.
  std::vector<std::string> keys() const;
  // "file:line:column" of a key, for the caller's own messages; the file's name if it is absent.
  std::string where(const std::string& key) const;
  bool has(const std::string& key) const;

  // Throws UserError for the first key, here or in any sub-table, that nobody read.
  void reject_unknown_keys() const;
  // All parameters read so far, with the value in effect, in order of first reading. Dotted keys.
  std::vector<ParameterDoc> describe() const;

 private:
  struct State;
  explicit Section(std::shared_ptr<State> state, std::string path);
  std::string full_key(const std::string& key) const;
  std::int64_t get_integer(const std::string& key, std::optional<std::int64_t> fallback,
                           std::int64_t least, std::int64_t most, const std::string& unit,
                           const std::string& sentence) const;
  double get_number(const std::string& key, std::optional<double> fallback, double least,
                    double most, const std::string& unit, const std::string& sentence) const;
  std::string get_choice(const std::string& key, const std::optional<std::string>& fallback,
                         const std::vector<std::string>& allowed,
                         const std::string& sentence) const;
  template <class T>
  T get_any(const std::string& key, const std::optional<T>& fallback, const std::string& allowed,
            const std::string& unit, const std::string& sentence) const;
  std::shared_ptr<State> state_;
  std::string path_;
};

}  // namespace a2rt::config
