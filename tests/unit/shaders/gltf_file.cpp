#include "gltf_file.h"

#include <stdlib.h>

#include <cstring>
#include <fstream>

namespace a2rt::test {
namespace {

std::string base64(const std::vector<unsigned char>& bytes) {
  static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      word = word << 8U | (i + c < bytes.size() ? bytes[i + c] : 0U);
    }
    for (unsigned c = 0; c < 4; ++c) {
      out += i + c > bytes.size() ? '=' : kDigits[word >> (18 - 6 * c) & 63U];
    }
  }
  return out;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "a2rt-XXXXXX").string();
  path_ = mkdtemp(name.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name,
                                             const std::string& text) const {
  const std::filesystem::path file = path_ / name;
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::string QuadFile::text() const {
  std::vector<unsigned char> bytes(positions.size() * 4 + indices.size() * 2);
  std::memcpy(bytes.data(), positions.data(), positions.size() * 4);
  std::memcpy(bytes.data() + positions.size() * 4, indices.data(), indices.size() * 2);
  std::string names, accessors, views;
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    const std::vector<float>& values = attributes[i].values;
    const std::size_t at = bytes.size();
    bytes.resize(at + values.size() * 4);
    std::memcpy(bytes.data() + at, values.data(), values.size() * 4);
    const std::string number = std::to_string(i + 2);
    names += ", \"" + attributes[i].name + "\": " + number;
    accessors += R"(, {"bufferView": )" + number +
                 R"(, "componentType": 5126, "count": 4, "type": ")" + attributes[i].type + "\"}";
    views += R"(, {"buffer": 0, "byteOffset": )" + std::to_string(at) + R"(, "byteLength": )" +
             std::to_string(values.size() * 4) + "}";
  }
  const std::string split = std::to_string(positions.size() * 4);
  const std::string data = "{\"byteLength\": " + std::to_string(bytes.size()) +
                           ", \"uri\": \"data:application/octet-stream;base64," + base64(bytes) +
                           "\"}";
  return "{" + extra + R"("asset": {"version": ")" + version + R"("}, "scene": 0, "scenes": [)" +
         scene + R"(], "nodes": )" + nodes +
         R"(, "meshes": [{"name": "quad", "primitives": [{"attributes": {"POSITION": 0)" + names +
         R"(}, "indices": 1, "material": 0}]}], "materials": [)" + material +
         R"(], "accessors": [)" + vertex_accessor + ", " + index_accessor + accessors +
         R"(], "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": )" + split +
         R"(}, {"buffer": 0, "byteOffset": )" + split + R"(, "byteLength": )" +
         std::to_string(indices.size() * 2) + "}" + views + R"(], "buffers": [)" +
         (buffer.empty() ? data : buffer) + "]}";
}

}  // namespace a2rt::test
