// Small glTF files written by hand for the tests.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace a2rt::test {

// A folder that disappears with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

// A glTF file with one quad of four vertices (two triangles) in the plane z = 0, from -1 to 1. Each
// part may be replaced by other JSON text.
struct QuadFile {
  std::vector<float> positions = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  std::vector<unsigned short> indices = {0, 1, 2, 0, 2, 3};
  std::string material = R"({"name": "paint", "pbrMetallicRoughness": {
    "baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 1}})";
  std::string nodes = R"([{"name": "quad", "mesh": 0}])";
  std::string scene = R"({"nodes": [0]})";
  std::string version = "2.0";
  std::string extra;  // further top-level members, each ending in a comma
  std::string vertex_accessor = R"({"bufferView": 0, "componentType": 5126, "count": 4,
    "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]})";
  std::string index_accessor =
      R"({"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"})";
  std::string buffer;  // empty: the data as a URI
  // Further vertex attributes: accessor 2 is the first of them.
  struct Attribute {
    std::string name, type;  // e.g. "TEXCOORD_0", "VEC2"
    std::vector<float> values;
  };
  std::vector<Attribute> attributes;
  // Texture axes: u to the right, v down, as pictures.
  static Attribute picture_coordinates() {
    return {"TEXCOORD_0", "VEC2", {0, 1, 1, 1, 1, 0, 0, 0}};
  }
  std::string text() const;
};

}  // namespace a2rt::test
