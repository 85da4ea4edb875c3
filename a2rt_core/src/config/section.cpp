#include "a2rt/config/section.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "a2rt/base/error.h"
#include "document.h"

namespace a2rt::config {

struct Section::State {
  std::string name;  // of the file, for messages about absent keys
  Document document;
  std::set<std::string> used;
  std::vector<ParameterDoc> docs;

  static std::shared_ptr<State> make(const std::string& name, Document document,
                                     const std::vector<std::string>& overrides);
  template <class T>
  struct Reader;
};

namespace {

std::string join(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) {
    out += (out.empty() ? "" : ", ") + word;
  }
  return out;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    row[j] = j;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

// The table a key lives in ("" for the top) and the key's own name.
std::pair<std::string, std::string> split(const std::string& full) {
  const bool closing = full.ends_with(']');
  const auto cut = closing ? full.rfind('[') : full.rfind('.');
  return cut == std::string::npos ? std::pair{std::string(), full}
                                  : std::pair{full.substr(0, cut), full.substr(cut + 1)};
}

// Remedy for a misspelt key: the nearest key that was read in the same table, or all of them.
std::string suggestion(const std::string& unknown, const std::set<std::string>& read) {
  const auto [table, name] = split(unknown);
  std::vector<std::string> known;
  std::string nearest;
  std::size_t least = 3;
  for (const auto& key : read) {
    const auto [other_table, other] = split(key);
    if (other_table == table) {
      known.push_back(other);
      const std::size_t distance = edit_distance(name, other);
      if (distance < least) {
        least = distance;
        nearest = other;
      }
    }
  }
  if (!nearest.empty()) {
    return "; did you mean '" + nearest + "'?";
  }
  return known.empty() ? std::string("; nothing is configured here")
                       : "; known here: " + join(known);
}

template <class T>
std::optional<T> convert(const Value& value) {
  if constexpr (std::is_same_v<T, double>) {
    if (const auto* v = std::get_if<std::int64_t>(&value)) {
      return static_cast<double>(*v);
    }
  }
  if constexpr (std::is_same_v<T, Numbers>) {
    if (const auto* v = std::get_if<Integers>(&value)) {
      return Numbers(v->begin(), v->end());
    }
  }
  if constexpr (std::is_same_v<T, Numbers> || std::is_same_v<T, Texts>) {
    if (std::holds_alternative<EmptyArray>(value)) {
      return T{};
    }
  }
  if (const auto* v = std::get_if<T>(&value)) {
    return *v;
  }
  return std::nullopt;
}

}  // namespace

// What the typed getters share; T is the type asked for.
template <class T>
struct Section::State::Reader {
  State& state;
  std::string key;
  std::string unit, sentence;
  std::string allowed;  // completes "must be ..."

  [[noreturn]] void fail(const Entry& entry, const std::string& problem) const {
    throw UserError(entry.where + ": " + key + " is " + problem + ", must be " + allowed + " (" +
                    sentence + ")");
  }
  // `accept` returns whether the value is in range.
  template <class Accept>
  T get(const std::optional<T>& fallback, Accept&& accept) const {
    const auto it = state.document.find(key);
    if (it == state.document.end() && !fallback) {
      throw UserError(state.name + ": " + key + " is missing, must be " + allowed + " (" +
                      sentence + ")");
    }
    const T value = it == state.document.end() ? *fallback : checked(it->second, accept);
    if (state.used.insert(key).second) {
      state.docs.push_back({key, unit, sentence, to_text(Value{value})});
    }
    return value;
  }
  template <class Accept>
  T checked(const Entry& entry, Accept&& accept) const {
    const auto value = convert<T>(entry.value);
    if (!value) {
      fail(entry, type_name(entry.value));
    }
    if (!accept(*value)) {
      fail(entry, to_text(entry.value));
    }
    return *value;
  }
};

namespace {
constexpr auto kAny = [](const auto&) { return true; };

std::string range_text(const std::string& noun, const std::string& least, const std::string& most,
                       const std::string& unit) {
  return noun + " from " + least + " to " + most + (unit.empty() ? "" : " " + unit);
}
}  // namespace

Section::Section(std::shared_ptr<State> state, std::string path)
    : state_(std::move(state)), path_(std::move(path)) {}

std::string Section::full_key(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

std::shared_ptr<Section::State> Section::State::make(const std::string& name, Document document,
                                                     const std::vector<std::string>& overrides) {
  Document all;
  std::size_t sequence = std::size_t{1} << 40;  // after every key of every file
  for (const auto& text : overrides) {
    Document one = parse_override(text);
    for (auto& [key, entry] : one) {
      const bool table = std::holds_alternative<TableMark>(entry.value);
      if (!table && all.contains(key)) {
        throw UserError(entry.where + ": " + key + " is already set by " + all[key].where +
                        "; give it once");
      }
      entry.sequence = sequence++;
    }
    overlay(all, std::move(one));
  }
  overlay(document, std::move(all));
  return std::make_shared<State>(State{name, std::move(document), {}, {}});
}

Section Section::from_file(const std::filesystem::path& file,
                           const std::vector<std::string>& overrides) {
  return Section(State::make(file.string(), read_toml(file), overrides), "");
}

Section Section::from_text(std::string_view text, const std::string& name,
                           const std::vector<std::string>& overrides) {
  return Section(State::make(name, parse_toml(text, name), overrides), "");
}

std::int64_t Section::get_integer(const std::string& key, std::optional<std::int64_t> fallback,
                                  std::int64_t least, std::int64_t most, const std::string& unit,
                                  const std::string& sentence) const {
  const std::string allowed =
      range_text("an integer", std::to_string(least), std::to_string(most), unit);
  return State::Reader<std::int64_t>{*state_, full_key(key), unit, sentence, allowed}.get(
      fallback, [&](std::int64_t v) { return v >= least && v <= most; });
}

double Section::get_number(const std::string& key, std::optional<double> fallback, double least,
                           double most, const std::string& unit,
                           const std::string& sentence) const {
  const std::string allowed = range_text("a number", to_text(least), to_text(most), unit);
  return State::Reader<double>{*state_, full_key(key), unit, sentence, allowed}.get(
      fallback, [&](double v) { return v >= least && v <= most; });
}

std::string Section::get_choice(const std::string& key, const std::optional<std::string>& fallback,
                                const std::vector<std::string>& allowed,
                                const std::string& sentence) const {
  return State::Reader<std::string>{*state_, full_key(key), "", sentence, "one of " + join(allowed)}
      .get(fallback, [&](const std::string& v) {
        return std::find(allowed.begin(), allowed.end(), v) != allowed.end();
      });
}

template <class T>
T Section::get_any(const std::string& key, const std::optional<T>& fallback,
                   const std::string& allowed, const std::string& unit,
                   const std::string& sentence) const {
  return State::Reader<T>{*state_, full_key(key), unit, sentence, allowed}.get(fallback, kAny);
}

std::int64_t Section::integer(const std::string& key, std::int64_t fallback, std::int64_t least,
                              std::int64_t most, const std::string& unit,
                              const std::string& sentence) const {
  return get_integer(key, fallback, least, most, unit, sentence);
}
std::int64_t Section::integer(const std::string& key, std::int64_t least, std::int64_t most,
                              const std::string& unit, const std::string& sentence) const {
  return get_integer(key, std::nullopt, least, most, unit, sentence);
}
double Section::number(const std::string& key, double fallback, double least, double most,
                       const std::string& unit, const std::string& sentence) const {
  return get_number(key, fallback, least, most, unit, sentence);
}
double Section::number(const std::string& key, double least, double most, const std::string& unit,
                       const std::string& sentence) const {
  return get_number(key, std::nullopt, least, most, unit, sentence);
}
bool Section::boolean(const std::string& key, bool fallback, const std::string& sentence) const {
  return get_any<bool>(key, fallback, "true or false", "", sentence);
}
std::string Section::text(const std::string& key, const std::string& fallback,
                          const std::string& sentence) const {
  return get_any<std::string>(key, fallback, "a string", "", sentence);
}
std::string Section::text(const std::string& key, const std::string& sentence) const {
  return get_any<std::string>(key, std::nullopt, "a string", "", sentence);
}
std::string Section::choice(const std::string& key, const std::string& fallback,
                            const std::vector<std::string>& allowed,
                            const std::string& sentence) const {
  return get_choice(key, fallback, allowed, sentence);
}
std::string Section::choice(const std::string& key, const std::vector<std::string>& allowed,
                            const std::string& sentence) const {
  return get_choice(key, std::nullopt, allowed, sentence);
}
std::vector<double> Section::numbers(const std::string& key, const std::vector<double>& fallback,
                                     const std::string& unit, const std::string& sentence) const {
  return get_any<Numbers>(key, fallback, "an array of numbers", unit, sentence);
}
std::vector<double> Section::numbers(const std::string& key, const std::string& unit,
                                     const std::string& sentence) const {
  return get_any<Numbers>(key, std::nullopt, "an array of numbers", unit, sentence);
}
std::vector<std::string> Section::texts(const std::string& key,
                                        const std::vector<std::string>& fallback,
                                        const std::string& sentence) const {
  return get_any<Texts>(key, fallback, "an array of strings", "", sentence);
}
std::vector<std::string> Section::texts(const std::string& key, const std::string& sentence) const {
  return get_any<Texts>(key, std::nullopt, "an array of strings", "", sentence);
}

Section Section::table(const std::string& key) const {
  const std::string full = full_key(key);
  const auto it = state_->document.find(full);
  if (it != state_->document.end() && !std::holds_alternative<TableMark>(it->second.value)) {
    throw UserError(it->second.where + ": " + full + " is " + type_name(it->second.value) +
                    ", must be a table: [" + full + "]");
  }
  state_->used.insert(full);
  return Section(state_, full);
}

std::vector<Section> Section::tables(const std::string& key) const {
  const std::string full = full_key(key);
  const auto it = state_->document.find(full);
  std::vector<Section> all;
  state_->used.insert(full);
  if (it == state_->document.end() || std::holds_alternative<EmptyArray>(it->second.value)) {
    return all;
  }
  const auto* mark = std::get_if<TableArrayMark>(&it->second.value);
  if (mark == nullptr) {
    throw UserError(it->second.where + ": " + full + " is " + type_name(it->second.value) +
                    ", must be an array of tables: [[" + full + "]]");
  }
  for (std::size_t i = 0; i < mark->count; ++i) {
    const std::string element = full + "[" + std::to_string(i) + "]";
    state_->used.insert(element);
    all.push_back(Section(state_, element));
  }
  return all;
}

bool Section::has(const std::string& key) const { return state_->document.contains(full_key(key)); }

std::string Section::where(const std::string& key) const {
  const auto it = state_->document.find(full_key(key));
  return it == state_->document.end() ? state_->name : it->second.where;
}

std::vector<std::string> Section::keys() const {
  std::vector<std::pair<std::size_t, std::string>> found;
  for (const auto& [full, entry] : state_->document) {
    const auto [table, name] = split(full);
    if (table == path_ && !full.ends_with(']')) {
      found.emplace_back(entry.sequence, name);
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> names;
  for (auto& item : found) {
    names.push_back(std::move(item.second));
  }
  return names;
}

void Section::reject_unknown_keys() const {
  const std::pair<const std::string, Entry>* first = nullptr;
  for (const auto& item : state_->document) {
    const bool here = path_.empty() || item.first.starts_with(path_ + ".");
    if (here && !state_->used.contains(item.first) &&
        (first == nullptr || item.second.sequence < first->second.sequence)) {
      first = &item;
    }
  }
  if (first != nullptr) {
    throw UserError(first->second.where + ": unknown key '" + first->first + "'" +
                    suggestion(first->first, state_->used));
  }
}

std::vector<ParameterDoc> Section::describe() const { return state_->docs; }

}  // namespace a2rt::config
