#include "gltf/exporter.h"

#include "a2rt/base/error.h"

namespace a2rt::gltf {
void save(const scene::Scene&, const std::filesystem::path& file) {
  throw UserError(file.string() + ": export");
}
}  // namespace a2rt::gltf
