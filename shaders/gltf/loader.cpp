#include "gltf/loader.h"

#include "a2rt/base/error.h"
#include "gltf/parts.h"

namespace a2rt::gltf {

scene::Scene load(const std::filesystem::path& file, const LoadOptions& options) {
  Document document(file);
  scene::Scene scene;
  scene.name = file.stem().string();
  const std::vector<int> uv_sets = load_materials(document, options, scene);
  load_nodes(document, uv_sets, scene);
  if (scene.inactive_triangles > 0) {
    document.warn(std::to_string(scene.inactive_triangles) +
                  " triangles are inactive (a vertex has x = NaN) and left out");
  }
  scene.warnings = document.warnings();
  try {
    scene::validate(scene);
  } catch (const UserError& e) {
    document.fail(e.what());
  }
  return scene;
}

}  // namespace a2rt::gltf
