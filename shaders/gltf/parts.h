// The parts of the loader, in the order they run.
#pragma once

#include <glm/mat4x4.hpp>
#include <vector>

#include "gltf/document.h"
#include "gltf/loader.h"

namespace a2rt::gltf {

// Fills Scene::textures and materials. Material i of the file becomes material i; one default
// material is added at the end for primitives that name none. Returns per material the texture
// coordinate set it uses.
std::vector<int> load_materials(Document& document, const LoadOptions& options,
                                scene::Scene& scene);

// uv' = matrix * (u, v, 1) of a material's textures (KHR_texture_transform).
struct UvTransform {
  double m[2][3] = {{1, 0, 0}, {0, 1, 0}};
  bool identity = true;
};
UvTransform uv_transform(Document& document, int material);

// One mesh with all its primitives; `joints` are the skinning matrices, empty without a skin.
scene::Mesh load_mesh(Document& document, int mesh, const std::vector<int>& uv_sets,
                      const std::vector<glm::dmat4>& joints, scene::Scene& scene);

// Walks the default scene: instances, cameras, lights, skins. Needs the materials.
void load_nodes(Document& document, const std::vector<int>& uv_sets, scene::Scene& scene);

// Extras of the glTF scene: name, sky, light, LumiBench's marks.
void load_scene_extras(Document& document, const tinygltf::Scene& from, scene::Scene& scene);

}  // namespace a2rt::gltf
