#include "gltf/document.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>

#include "a2rt/base/error.h"

namespace a2rt::gltf {
namespace {

const std::set<std::string> kSupported = {
    "KHR_materials_transmission", "KHR_materials_ior",
    "KHR_materials_volume",       "KHR_materials_emissive_strength",
    "KHR_materials_clearcoat",    "KHR_lights_punctual",
    "EXT_mesh_gpu_instancing",    "KHR_mesh_quantization",
    "KHR_texture_transform",      "A2RT_procedural"};

// Images stay encoded here; textures.cpp decodes them. The bytes of buffer-view images are not
// touched, because tinygltf does not check that they lie inside the buffer.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0 && size > 0) {
    image->image.assign(bytes, bytes + size);
    image->as_is = true;
  }
  return true;
}

double component_at(const std::uint8_t* p, int type, bool normalized) {
  const auto read = [&]<class T>(T) {
    T value;
    std::memcpy(&value, p, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalized ? std::max(read(std::int8_t{}) / 127.0, -1.0) : read(std::int8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return read(std::uint8_t{}) / (normalized ? 255.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized ? std::max(read(std::int16_t{}) / 32767.0, -1.0) : read(std::int16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return read(std::uint16_t{}) / (normalized ? 65535.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return read(std::uint32_t{});
    default:
      return read(float{});
  }
}

bool known_component(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         type == TINYGLTF_COMPONENT_TYPE_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT || type == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

// tinygltf before 2.9 keeps the offsets of sparse accessors as int, later ones as size_t.
std::size_t offset_of(auto given) {
  return static_cast<std::size_t>(std::max(std::int64_t{0}, static_cast<std::int64_t>(given)));
}

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') {
    text.pop_back();
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// tinygltf's errors about files beside the glTF file are mended there, all others inside it.
const char* remedy_of(const std::string& errors) {
  for (const char* beside : {"File not found", "File size mismatch", "a file that it names"}) {
    if (errors.find(beside) != std::string::npos) {
      return "put the files that its buffers name beside it, or export it as one .glb file";
    }
  }
  return kRepairFile;
}

// The loader's own test of existence takes a folder for a file, whose size is then beyond memory.
bool is_file(const std::string& path, void*) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

// Later versions of the library also ask for sizes, earlier ones have no such member.
template <class Callbacks>
Callbacks callbacks_for_files() {
  Callbacks callbacks{};
  callbacks.FileExists = &is_file;
  callbacks.ExpandFilePath = &tinygltf::ExpandFilePath;
  callbacks.ReadWholeFile = &tinygltf::ReadWholeFile;
  callbacks.WriteWholeFile = &tinygltf::WriteWholeFile;
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string& path,
                                      void*) {
      std::error_code error;
      *size = static_cast<std::size_t>(std::filesystem::file_size(path, error));
      return !error;
    };
  }
  return callbacks;
}

}  // namespace

Document::Document(const std::filesystem::path& file) : file_(file) {
  parse();
  check_version();
  check_extensions();
}

void Document::fail(const std::string& what, const std::string& remedy) const {
  throw UserError(file_.string() + ": " + what + "; " + remedy);
}

void Document::warn(const std::string& what) {
  if (std::find(warnings_.begin(), warnings_.end(), what) == warnings_.end()) {
    warnings_.push_back(what);
  }
}

void Document::parse() {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file_, error)) {
    fail("no such file", "give a .gltf or .glb file or the name of an embedded scene");
  }
  char magic[4] = {};
  std::ifstream(file_, std::ios::binary).read(magic, sizeof magic);
  const bool binary = std::memcmp(magic, "glTF", 4) == 0;
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, nullptr);
  loader.SetFsCallbacks(callbacks_for_files<tinygltf::FsCallbacks>());
  std::string errors, warnings;
  bool ok = false;
  try {
    ok = binary ? loader.LoadBinaryFromFile(&model_, &errors, &warnings, file_.string())
                : loader.LoadASCIIFromFile(&model_, &errors, &warnings, file_.string());
  } catch (const std::bad_alloc&) {
    errors = "a file that it names is larger than memory";
  } catch (const std::exception& e) {
    errors = e.what();
  }
  if (!ok) {
    fail("not a readable glTF 2.0 file: " + (errors.empty() ? "unknown reason" : one_line(errors)),
         remedy_of(errors));
  }
}

void Document::check_version() const {
  const std::string& version = model_.asset.version;
  if (!version.starts_with("2.")) {
    fail("its glTF version is '" + version + "'; only 2.x is read", "convert it to glTF 2.0");
  }
}

void Document::check_extensions() {
  std::string missing;
  for (const std::string& name : model_.extensionsRequired) {
    if (!kSupported.contains(name)) {
      missing += (missing.empty() ? "" : ", ") + name;
    }
  }
  if (!missing.empty()) {
    fail("the file requires " + missing + ", which this program does not support",
         "export it without");
  }
  for (const std::string& name : model_.extensionsUsed) {
    if (!kSupported.contains(name)) {
      warn("extension " + name + " is not supported and is ignored");
    }
  }
}

std::size_t Document::components(int accessor) const {
  const tinygltf::Accessor& a = get(model_.accessors, accessor, "accessor");
  const int n = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
  if (n <= 0 || !known_component(a.componentType)) {
    fail("accessor " + std::to_string(accessor) + " has an unknown element type");
  }
  return static_cast<std::size_t>(n);
}

std::vector<std::uint8_t> Document::view_bytes(int view, const std::string& use) const {
  const tinygltf::BufferView& v = get(model_.bufferViews, view, "buffer view");
  const tinygltf::Buffer& b = get(model_.buffers, v.buffer, "buffer");
  if (v.byteOffset > b.data.size() || v.byteLength > b.data.size() - v.byteOffset) {
    fail(use + ": buffer view " + std::to_string(view) + " reaches beyond the " +
         std::to_string(b.data.size()) + " bytes of its buffer");
  }
  const auto first = b.data.begin() + static_cast<std::ptrdiff_t>(v.byteOffset);
  return {first, first + static_cast<std::ptrdiff_t>(v.byteLength)};
}

void Document::add_elements(Numbers& out, const tinygltf::Accessor& a, int index,
                            const std::string& use) const {
  const std::string where = use + ": accessor " + std::to_string(index);
  const tinygltf::BufferView& v = get(model_.bufferViews, a.bufferView, "buffer view");
  const tinygltf::Buffer& b = get(model_.buffers, v.buffer, "buffer");
  const auto component_bytes = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType)));
  const std::size_t element = component_bytes * out.components;
  const std::size_t stride = v.byteStride == 0 ? element : v.byteStride;
  if (stride < element) {
    fail(where + ": the stride of its buffer view is smaller than an element");
  }
  if (v.byteOffset > b.data.size() || v.byteLength > b.data.size() - v.byteOffset ||
      a.byteOffset > v.byteLength) {
    fail(where + ": it starts beyond the end of its buffer (" + std::to_string(b.data.size()) +
         " bytes)");
  }
  const std::size_t room = v.byteLength - a.byteOffset;
  if (a.count > 0 && (room < element || (a.count - 1) > (room - element) / stride)) {
    fail(where + ": its " + std::to_string(a.count) +
         " elements reach beyond the end of its buffer view");
  }
  const std::uint8_t* base = b.data.data() + v.byteOffset + a.byteOffset;
  out.values.resize(a.count * out.components);
  for (std::size_t i = 0; i < a.count; ++i) {
    for (std::size_t c = 0; c < out.components; ++c) {
      out.values[i * out.components + c] =
          component_at(base + i * stride + c * component_bytes, a.componentType, a.normalized);
    }
  }
}

void Document::add_sparse(Numbers& out, const tinygltf::Accessor& a, const std::string& use) const {
  const auto& sparse = a.sparse;
  const auto read = [&](int view, std::size_t offset, int type, std::size_t components) {
    tinygltf::Accessor part;
    part.bufferView = view;
    part.byteOffset = offset;
    part.componentType = type;
    part.normalized = a.normalized && components > 0 && type == a.componentType;
    part.count = sparse.count < 0 ? 0 : static_cast<std::size_t>(sparse.count);
    Numbers numbers;
    numbers.components = components;
    numbers.count = part.count;
    add_elements(numbers, part, -1, use + " (sparse)");
    return numbers;
  };
  if (!known_component(sparse.indices.componentType)) {
    fail(use + ": sparse indices have an unknown type");
  }
  const Numbers at = read(sparse.indices.bufferView, offset_of(sparse.indices.byteOffset),
                          sparse.indices.componentType, 1);
  const Numbers with = read(sparse.values.bufferView, offset_of(sparse.values.byteOffset),
                            a.componentType, out.components);
  for (std::size_t i = 0; i < at.count; ++i) {
    const double element = at.at(i, 0);
    if (!(element >= 0 && element < static_cast<double>(out.count))) {
      fail(use + ": a sparse index is outside the accessor");
    }
    for (std::size_t c = 0; c < out.components; ++c) {
      out.values[static_cast<std::size_t>(element) * out.components + c] = with.at(i, c);
    }
  }
}

Numbers Document::numbers(int accessor, std::size_t wanted, const std::string& use) const {
  const tinygltf::Accessor& a = get(model_.accessors, accessor, "accessor");
  Numbers out;
  out.components = components(accessor);
  out.count = a.count;
  if (wanted != 0 && out.components != wanted) {
    fail(use + ": accessor " + std::to_string(accessor) + " has " + std::to_string(out.components) +
         " components an element, not " + std::to_string(wanted));
  }
  // An accessor without data is zeros; no honest file has more of them than this.
  constexpr std::size_t kMostZeros = std::size_t{1} << 26U;
  if (a.bufferView >= 0) {
    add_elements(out, a, accessor, use);
  } else if (a.count <= kMostZeros) {
    out.values.assign(a.count * out.components, 0);
  } else {
    fail(use + ": accessor " + std::to_string(accessor) + " has no data and too many elements");
  }
  if (a.sparse.isSparse) {
    add_sparse(out, a, use);
  }
  return out;
}

const tinygltf::Value& member(const tinygltf::Value& object, std::string_view key) {
  static const tinygltf::Value kNull;
  const std::string name(key);
  return object.IsObject() && object.Has(name) ? object.Get(name) : kNull;
}

const tinygltf::Value& extension(const tinygltf::ExtensionMap& all, std::string_view name) {
  static const tinygltf::Value kNull;
  const auto it = all.find(std::string(name));
  return it == all.end() ? kNull : it->second;
}

double number_or(const tinygltf::Value& object, std::string_view key, double fallback) {
  const tinygltf::Value& v = member(object, key);
  return v.IsNumber() ? v.GetNumberAsDouble() : fallback;
}

bool boolean_or(const tinygltf::Value& object, std::string_view key, bool fallback) {
  const tinygltf::Value& v = member(object, key);
  return v.IsBool() ? v.Get<bool>() : fallback;
}

std::string text_or(const tinygltf::Value& object, std::string_view key,
                    const std::string& fallback) {
  const tinygltf::Value& v = member(object, key);
  return v.IsString() ? v.Get<std::string>() : fallback;
}

std::vector<double> array_of(const tinygltf::Value& object, std::string_view key) {
  const tinygltf::Value& v = member(object, key);
  std::vector<double> numbers;
  if (v.IsArray()) {
    for (std::size_t i = 0; i < v.ArrayLen(); ++i) {
      const tinygltf::Value& element = v.Get(static_cast<int>(i));
      if (!element.IsNumber()) {
        return {};
      }
      numbers.push_back(element.GetNumberAsDouble());
    }
  }
  return numbers;
}

}  // namespace a2rt::gltf
