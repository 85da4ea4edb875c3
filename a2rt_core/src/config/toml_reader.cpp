// The one file that includes toml++ (its compile time is why).
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "a2rt/base/error.h"
#include "document.h"

namespace a2rt::config {
namespace {

std::string place(const std::string& name, const toml::source_region& source) {
  return name + ":" + std::to_string(source.begin.line) + ":" + std::to_string(source.begin.column);
}

std::string quoted_if_needed(std::string_view key) {
  const bool bare = !key.empty() && key.find_first_of(".[]\" \t") == std::string_view::npos;
  return bare ? std::string(key) : "\"" + std::string(key) + "\"";
}

// Turns a parsed table into the flat document.
class Flattener {
 public:
  explicit Flattener(const std::string& name) : name_(name) {}

  void table(const toml::table& values, const std::string& path) {
    for (const auto& [key, node] : values) {
      const std::string full = (path.empty() ? "" : path + ".") + quoted_if_needed(key.str());
      node_at(node, full, place(name_, key.source()));
    }
  }
  Document take() && {
    number_entries();
    return std::move(document_);
  }

 private:
  void node_at(const toml::node& node, const std::string& path, const std::string& where) {
    Entry entry{value_of(node), where, order(where)};
    const bool tables = std::holds_alternative<TableArrayMark>(entry.value);
    document_[path] = std::move(entry);
    if (const auto* inner = node.as_table()) {
      table(*inner, path);
    } else if (tables) {
      std::size_t i = 0;
      for (const auto& element : *node.as_array()) {
        node_at(element, path + "[" + std::to_string(i++) + "]", place(name_, element.source()));
      }
    }
  }
  // Line and column as one sortable number; table() sees keys in alphabetical order.
  static std::size_t order(const std::string& where) {
    const auto column = where.rfind(':');
    const auto line = where.rfind(':', column - 1);
    return std::stoul(where.substr(line + 1, column - line - 1)) * 65536 +
           std::stoul(where.substr(column + 1));
  }
  void number_entries() {
    std::vector<Entry*> entries;
    for (auto& item : document_) {
      entries.push_back(&item.second);
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry* a, const Entry* b) { return a->sequence < b->sequence; });
    for (std::size_t i = 0; i < entries.size(); ++i) {
      entries[i]->sequence = i;
    }
  }
  static Value value_of(const toml::node& node) {
    if (node.is_table()) {
      return TableMark{};
    }
    if (const auto* v = node.as_boolean()) {
      return v->get();
    }
    if (const auto* v = node.as_integer()) {
      return v->get();
    }
    if (const auto* v = node.as_floating_point()) {
      return v->get();
    }
    if (const auto* v = node.as_string()) {
      return v->get();
    }
    if (const auto* v = node.as_array()) {
      return array_value(*v);
    }
    return OtherMark{"a date or time"};
  }
  static Value array_value(const toml::array& array) {
    if (array.empty()) {
      return EmptyArray{};
    }
    const auto all = [&](auto&& test) { return std::all_of(array.begin(), array.end(), test); };
    if (all([](const toml::node& n) { return n.is_table(); })) {
      return TableArrayMark{array.size()};
    }
    if (all([](const toml::node& n) { return n.is_integer(); })) {
      return collect<std::int64_t>(array);
    }
    if (all([](const toml::node& n) { return n.is_number(); })) {
      return collect<double>(array);
    }
    if (all([](const toml::node& n) { return n.is_string(); })) {
      return collect<std::string>(array);
    }
    return OtherMark{"an array of mixed or nested values"};
  }
  template <class T>
  static std::vector<T> collect(const toml::array& array) {
    std::vector<T> values;
    for (const auto& node : array) {
      values.push_back(*node.value<T>());
    }
    return values;
  }

  const std::string& name_;
  Document document_;
};

std::string read_text(const std::filesystem::path& file, const std::string& asked_at) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  if (in && !std::filesystem::is_directory(file)) {
    text.assign(std::istreambuf_iterator<char>(in), {});  // unlike <<, at ease with an empty file
  }
  if (!in || std::filesystem::is_directory(file)) {
    throw UserError(asked_at + "cannot read the configuration file '" + file.string() +
                    "'; check the path");
  }
  return text;
}

Document read_chain(const std::filesystem::path& file, std::vector<std::filesystem::path>& chain,
                    const std::string& asked_at) {
  const auto identity = std::filesystem::weakly_canonical(file);
  if (std::find(chain.begin(), chain.end(), identity) != chain.end()) {
    throw UserError(asked_at + "'" + file.string() +
                    "' inherits from itself through this line; remove one `inherits`");
  }
  chain.push_back(identity);
  Document own = parse_toml(read_text(file, asked_at), file.string());
  const auto inherits = own.find("inherits");
  if (inherits == own.end()) {
    return own;
  }
  const std::string where = inherits->second.where + ": ";
  const auto* base_name = std::get_if<std::string>(&inherits->second.value);
  if (base_name == nullptr) {
    throw UserError(where + "inherits is " + type_name(inherits->second.value) +
                    ", must be a string: the file to start from, relative to this one");
  }
  Document base = read_chain(file.parent_path() / *base_name, chain, where);
  own.erase(inherits);
  for (auto& item : own) {
    item.second.sequence += base.size() + (std::size_t{1} << 20);
  }
  overlay(base, std::move(own));
  return base;
}

}  // namespace

Document parse_toml(std::string_view text, const std::string& name) {
  try {
    const toml::table parsed = toml::parse(text, std::string_view(name));
    Flattener flattener(name);
    flattener.table(parsed, "");
    return std::move(flattener).take();
  } catch (const toml::parse_error& e) {
    throw UserError(place(name, e.source()) + ": " + std::string(e.description()));
  }
}

Document read_toml(const std::filesystem::path& file) {
  std::vector<std::filesystem::path> chain;
  return read_chain(file, chain, "");
}

Document parse_override(const std::string& override_text) {
  const auto equals = override_text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw UserError("override '" + override_text + "' must have the form key=value");
  }
  const std::string name = "override '" + override_text + "'";
  const auto bare_word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '/';
  };
  const std::string value = override_text.substr(equals + 1);
  try {
    return parse_toml(override_text, name);
  } catch (const UserError&) {
    // A shell user writes unit=a2rt; TOML wants the word quoted.
    if (value.empty() || !std::all_of(value.begin(), value.end(), bare_word)) {
      throw;
    }
    return parse_toml(override_text.substr(0, equals) + "=\"" + value + "\"", name);
  }
}

}  // namespace a2rt::config
