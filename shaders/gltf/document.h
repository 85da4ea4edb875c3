// A parsed glTF file whose every reference is checked on the way out.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace a2rt::gltf {

// An element of an accessor as numbers: `components` values per element.
struct Numbers {
  std::size_t count = 0, components = 0;
  std::vector<double> values;
  double at(std::size_t element, std::size_t component) const {
    return values[element * components + component];
  }
};

// What to do about a file that contradicts itself.
inline constexpr const char* kRepairFile = "repair the file, or export it again";

class Document {
 public:
  // Parses and checks the extensions. Throws UserError.
  explicit Document(const std::filesystem::path& file);

  const tinygltf::Model& model() const { return model_; }
  // Throws UserError: file, what is wrong, what to do about it.
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = kRepairFile) const;
  void warn(const std::string& what);  // once per text
  const std::vector<std::string>& warnings() const { return warnings_; }

  // Element `index` of `list`; `what` names it in the error, e.g. "mesh".
  template <class T>
  const T& get(const std::vector<T>& list, int index, const std::string& what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) {
      fail("there is no " + what + " " + std::to_string(index) + " (the file has " +
           std::to_string(list.size()) + ")");
    }
    return list[static_cast<std::size_t>(index)];
  }

  // Reads an accessor of `components` numbers an element (0: any), sparse ones included; normalized
  // integers become [0, 1] or [-1, 1]. `use` says what it is for in errors.
  Numbers numbers(int accessor, std::size_t components, const std::string& use) const;
  // Number of components of an accessor's elements.
  std::size_t components(int accessor) const;
  // Bytes of a buffer view.
  std::vector<std::uint8_t> view_bytes(int view, const std::string& use) const;

 private:
  void parse();
  void check_version() const;
  void check_extensions();
  void add_elements(Numbers& out, const tinygltf::Accessor& a, int index,
                    const std::string& use) const;
  void add_sparse(Numbers& out, const tinygltf::Accessor& a, const std::string& use) const;

  std::filesystem::path file_;
  tinygltf::Model model_;
  std::vector<std::string> warnings_;
};

// Values of extras and extensions, with a fallback when absent or of another type.
double number_or(const tinygltf::Value& object, std::string_view key, double fallback);
bool boolean_or(const tinygltf::Value& object, std::string_view key, bool fallback);
std::string text_or(const tinygltf::Value& object, std::string_view key,
                    const std::string& fallback);
// Numbers of an array; empty if absent or not an array of numbers.
std::vector<double> array_of(const tinygltf::Value& object, std::string_view key);
// The member, or null.
const tinygltf::Value& member(const tinygltf::Value& object, std::string_view key);
const tinygltf::Value& extension(const tinygltf::ExtensionMap& all, std::string_view name);

}  // namespace a2rt::gltf
