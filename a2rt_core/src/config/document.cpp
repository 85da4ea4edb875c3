#include "document.h"

#include <charconv>
#include <cmath>

namespace a2rt::config {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
// Clang before 17 does not find this by itself.
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

std::string number_text(double v) {
  if (std::isnan(v)) {
    return "nan";
  }
  if (std::isinf(v)) {
    return v < 0 ? "-inf" : "inf";
  }
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, v).ptr;
  return {buffer, end};
}

std::string quoted(const std::string& v) {
  std::string out = "\"";
  for (const char c : v) {
    if (c == '"' || c == '\\') {
      out += '\\';
    }
    out += c;
  }
  return out + '"';
}

template <class T, class F>
std::string list_text(const std::vector<T>& values, F&& one) {
  std::string out = "[";
  for (const T& v : values) {
    out += (out.size() > 1 ? ", " : "") + one(v);
  }
  return out + "]";
}

bool is_below(const std::string& key, const std::string& table) {
  return key.size() > table.size() && key.starts_with(table) &&
         (key[table.size()] == '.' || key[table.size()] == '[');
}

void erase_below(Document& document, const std::string& table) {
  for (auto it = document.lower_bound(table); it != document.end();) {
    if (!it->first.starts_with(table)) {
      break;
    }
    it = is_below(it->first, table) ? document.erase(it) : std::next(it);
  }
}

}  // namespace

std::string type_name(const Value& value) {
  return std::visit(Overloaded{
                        [](const TableMark&) { return std::string("a table"); },
                        [](const TableArrayMark&) { return std::string("an array of tables"); },
                        [](const OtherMark& v) { return v.what; },
                        [](bool) { return std::string("a boolean"); },
                        [](std::int64_t) { return std::string("an integer"); },
                        [](double) { return std::string("a number"); },
                        [](const std::string&) { return std::string("a string"); },
                        [](const Integers&) { return std::string("an array of integers"); },
                        [](const Numbers&) { return std::string("an array of numbers"); },
                        [](const Texts&) { return std::string("an array of strings"); },
                        [](const EmptyArray&) { return std::string("an empty array"); },
                    },
                    value);
}

std::string to_text(const Value& value) {
  return std::visit(Overloaded{
                        [](const TableMark&) { return std::string("{...}"); },
                        [](const TableArrayMark&) { return std::string("[{...}]"); },
                        [](const OtherMark& v) { return v.what; },
                        [](bool v) { return std::string(v ? "true" : "false"); },
                        [](std::int64_t v) { return std::to_string(v); },
                        [](double v) { return number_text(v); },
                        [](const std::string& v) { return quoted(v); },
                        [](const Integers& v) {
                          return list_text(v, [](std::int64_t i) { return std::to_string(i); });
                        },
                        [](const Numbers& v) { return list_text(v, number_text); },
                        [](const Texts& v) { return list_text(v, quoted); },
                        [](const EmptyArray&) { return std::string("[]"); },
                    },
                    value);
}

void overlay(Document& lower, Document&& upper) {
  for (auto& [key, entry] : upper) {
    const bool table = std::holds_alternative<TableMark>(entry.value);
    const auto it = lower.find(key);
    const bool merges =
        table && it != lower.end() && std::holds_alternative<TableMark>(it->second.value);
    if (!merges) {
      erase_below(lower, key);
    }
    lower[key] = std::move(entry);
  }
}

}  // namespace a2rt::config
