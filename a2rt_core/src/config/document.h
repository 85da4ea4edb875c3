// A TOML document without its parser: values by dotted key, each with the place it came from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace a2rt::config {

struct TableMark {};
struct TableArrayMark {
  std::size_t count = 0;
};
// A TOML value that no parameter can take (dates, mixed arrays), by its name.
struct OtherMark {
  std::string what;
};
using Integers = std::vector<std::int64_t>;
using Numbers = std::vector<double>;
using Texts = std::vector<std::string>;
struct EmptyArray {};
using Value = std::variant<TableMark, TableArrayMark, OtherMark, bool, std::int64_t, double,
                           std::string, Integers, Numbers, Texts, EmptyArray>;

struct Entry {
  Value value;
  std::string where;         // "file:line:column"
  std::size_t sequence = 0;  // order of appearance, over all files
};

// Dotted key -> entry. Elements of an array of tables are "key[0]", "key[1]", ...
using Document = std::map<std::string, Entry>;

// "an integer", "a table", ...
std::string type_name(const Value& value);
// The value as TOML would write it.
std::string to_text(const Value& value);

// Lays `upper` over `lower`: its values win, tables are merged key by key.
void overlay(Document& lower, Document&& upper);

// The only functions that know the parser. All throw UserError naming file:line:column.
Document parse_toml(std::string_view text, const std::string& name);
// Reads the file and everything it inherits; the key `inherits` itself is left out.
Document read_toml(const std::filesystem::path& file);
// One override "key=value"; value is TOML, or a bare word taken as a string.
Document parse_override(const std::string& override_text);

}  // namespace a2rt::config
