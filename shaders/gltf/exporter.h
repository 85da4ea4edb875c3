// A scene as glTF 2.0.
#pragma once

#include <filesystem>

#include "scene/scene.h"

namespace a2rt::gltf {

// Writes .glb or .gltf by the file's extension, complete or not at all. Procedural shapes go into
// the optional extension A2RT_procedural, which other programs skip. Throws UserError.
void save(const scene::Scene& scene, const std::filesystem::path& file);

}  // namespace a2rt::gltf
