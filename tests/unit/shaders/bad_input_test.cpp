// Every malformed file ends in an error that names the place; none in a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "a2rt/base/error.h"
#include "gltf/loader.h"
#include "gltf_file.h"

namespace a2rt::test {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& text, const std::string& name = "bad.gltf") {
  const TemporaryFolder folder;
  try {
    gltf::load(folder.write(name, text));
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

struct Case {
  std::string name;
  std::function<void(QuadFile&)> break_it;
  std::string message;
};

class BadQuad : public ::testing::TestWithParam<Case> {};

TEST_P(BadQuad, IsRefusedWithItsReason) {
  QuadFile file;
  GetParam().break_it(file);
  const std::string error = error_of(file.text());
  EXPECT_THAT(error, HasSubstr(GetParam().message));
  EXPECT_THAT(error, HasSubstr("bad.gltf: "));
  EXPECT_THAT(error, HasSubstr("; ")) << "no remedy";
}

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Files, BadQuad,
    ::testing::Values(
        Case{"index_out_of_range", [](QuadFile& f) { f.indices[4] = 4; },
             "mesh 'quad', primitive 0: index 4 is outside its 4 vertices"},
        Case{"infinite_vertex", [](QuadFile& f) { f.positions[3] = kInf; },
             "mesh 'quad', primitive 0: vertex 1 is not finite"},
        Case{"nan_in_y", [](QuadFile& f) { f.positions[1] = kNan; }, "vertex 0 is not finite"},
        Case{"all_inactive", [](QuadFile& f) { f.positions[0] = kNan; }, "nothing to draw"},
        Case{"empty_scene", [](QuadFile& f) { f.scene = R"({"nodes": []})"; }, "nothing to draw"},
        Case{"too_many_vertices",
             [](QuadFile& f) {
               f.vertex_accessor =
                   R"({"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"})";
             },
             "reach beyond the end"},
        Case{"huge_count",
             [](QuadFile& f) {
               f.vertex_accessor = R"({"bufferView": 0, "componentType": 5126,
                 "count": 4611686018427387904, "type": "VEC3"})";
             },
             "reach beyond the end"},
        Case{"huge_offset",
             [](QuadFile& f) {
               f.vertex_accessor = R"({"bufferView": 0, "byteOffset": 1000000,
                 "componentType": 5126, "count": 4, "type": "VEC3"})";
             },
             "beyond the end"},
        Case{"float_indices",
             [](QuadFile& f) {
               f.index_accessor =
                   R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR"})";
             },
             "indices are floating-point"},
        Case{"positions_of_two",
             [](QuadFile& f) {
               f.vertex_accessor =
                   R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC2"})";
             },
             "2 components"},
        Case{"no_such_mesh", [](QuadFile& f) { f.nodes = R"([{"mesh": 7}])"; }, "no mesh 7"},
        Case{"no_such_root", [](QuadFile& f) { f.scene = R"({"nodes": [9]})"; }, "no node 9"},
        Case{"cycle", [](QuadFile& f) { f.nodes = R"([{"mesh": 0, "children": [0]}])"; },
             "reached twice"},
        Case{"infinite_transform",
             [](QuadFile& f) { f.nodes = R"([{"mesh": 0, "translation": [1e300, 0, 0]}])"; },
             "not finite"},
        Case{"required_extension",
             [](QuadFile& f) {
               f.extra = R"("extensionsUsed": ["EXT_meshopt_compression"],
                            "extensionsRequired": ["EXT_meshopt_compression"],)";
             },
             "requires EXT_meshopt_compression"},
        Case{"missing_buffer",
             [](QuadFile& f) { f.buffer = R"({"byteLength": 60, "uri": "absent.bin"})"; },
             "absent.bin; put the files that its buffers name beside it"},
        Case{"folder_as_buffer",
             [](QuadFile& f) { f.buffer = R"({"byteLength": 60, "uri": "."})"; },
             "put the files that its buffers name beside it"},
        Case{"no_buffer_where_one_is_named",
             [](QuadFile& f) {
               f.buffer = "";
               f.vertex_accessor = R"({"bufferView": 9, "componentType": 5126, "count": 4,
                 "type": "VEC3"})";
             },
             "there is no buffer view 9 (the file has 2); repair the file"},
        Case{"glTF_1", [](QuadFile& f) { f.version = "1.0"; },
             "its glTF version is '1.0'; only 2.x is read; convert it"},
        Case{"triangles_without_area",
             [](QuadFile& f) { f.positions.assign(f.positions.size(), 0.5F); },
             "none of its triangles and shapes has an area"},
        Case{"instances_without_area",
             [](QuadFile& f) { f.nodes = R"([{"mesh": 0, "scale": [0, 0, 0]}])"; },
             "none of its triangles and shapes has an area"},
        Case{"camera_without_area",
             [](QuadFile& f) {
               f.extra = R"("cameras": [{"type": "perspective",
                 "perspective": {"yfov": 0, "znear": 0.1}}],)";
               f.nodes = R"([{"mesh": 0}, {"name": "eye", "camera": 0}])";
               f.scene = R"({"nodes": [0, 1]})";
             },
             "sees no area"},
        Case{"camera_of_scale_zero",
             [](QuadFile& f) {
               f.extra = R"("cameras": [{"type": "perspective",
                 "perspective": {"yfov": 1, "znear": 0.1}}],)";
               f.nodes = R"([{"mesh": 0}, {"name": "eye", "camera": 0, "scale": [0, 0, 0]}])";
               f.scene = R"({"nodes": [0, 1]})";
             },
             "direction is zero"}),
    [](const auto& test) { return test.param.name; });

TEST(BadFile, AbsentTextAndTruncatedFilesAreRefused) {
  EXPECT_THROW(gltf::load("/nonexistent/scene.glb"), UserError);
  EXPECT_THAT(error_of("not json"), HasSubstr("not a readable glTF"));
  EXPECT_THAT(error_of(""), HasSubstr("not a readable glTF"));
  EXPECT_THAT(error_of("glTF\x02\0\0\0 short", "bad.glb"), HasSubstr("not a readable glTF"));
}

TEST(BadFile, EveryTruncationOfAGoodFileIsRefused) {
  const std::string whole = QuadFile{}.text();
  const TemporaryFolder folder;
  for (std::size_t length = 0; length < whole.size(); length += 37) {
    const auto file = folder.write("cut.gltf", whole.substr(0, length));
    EXPECT_THROW(gltf::load(file), UserError) << length << " bytes";
  }
}

}  // namespace
}  // namespace a2rt::test
