// glTF 2.0 (.gltf and .glb) into a scene.
#pragma once

#include <filesystem>

#include "scene/scene.h"

namespace a2rt::gltf {

struct LoadOptions {
  // An image that cannot be found or decoded: false: an error; true: a warning, and the texture is
  // left out.
  bool allow_missing_textures = true;
};

// Throws UserError naming file, element and remedy. What is read but not honoured is listed in
// Scene::warnings.
//
// Vertices that are not finite follow Vulkan's rule for inactive triangles: a triangle with a
// vertex whose x is NaN is left out and counted; any other NaN or infinity is an error that names
// mesh, primitive and vertex.
scene::Scene load(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace a2rt::gltf
