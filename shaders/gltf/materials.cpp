#include <stb/stb_image.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "gltf/parts.h"

namespace a2rt::gltf {
namespace {

using scene::kNoIndex;
using scene::Material;
using tinygltf::Value;

glm::vec3 color_of(const std::vector<double>& v, const glm::vec3& fallback) {
  return v.size() < 3 ? fallback : glm::vec3(v[0], v[1], v[2]);
}

scene::Wrap wrap_of(int mode) {
  return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? scene::Wrap::kClamp
         : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? scene::Wrap::kMirror
                                                         : scene::Wrap::kRepeat;
}

// Turns the file's textures into the scene's, each once per colour space.
class Textures {
 public:
  Textures(Document& document, const LoadOptions& options, scene::Scene& scene)
      : document_(document), options_(options), scene_(scene) {}

  std::uint32_t slot(int index, bool srgb) {
    if (index < 0) {
      return kNoIndex;
    }
    const auto known = slots_.find({index, srgb});
    if (known != slots_.end()) {
      return known->second;
    }
    const std::uint32_t made = load(index, srgb);
    slots_[{index, srgb}] = made;
    return made;
  }

 private:
  std::uint32_t load(int index, bool srgb) {
    const auto& texture = document_.get(document_.model().textures, index, "texture");
    if (texture.source < 0) {
      return missing("texture " + std::to_string(index) + " has no image");
    }
    const auto& image = document_.get(document_.model().images, texture.source, "image");
    scene::Texture t;
    t.srgb = srgb;
    t.name = image.name.empty() ? "image " + std::to_string(texture.source) : image.name;
    const std::string what =
        image.uri.empty() ? t.name : "image '" + image.uri.substr(0, 200) + "'";
    const std::vector<std::uint8_t> encoded =
        image.bufferView >= 0 ? document_.view_bytes(image.bufferView, t.name) : image.image;
    if (encoded.empty()) {
      return missing(what + " cannot be found");
    }
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(encoded.data(), static_cast<int>(encoded.size()), &width, &height,
                              &channels, 4),
        stbi_image_free);
    if (!pixels || width <= 0 || height <= 0) {
      return missing(what + " cannot be decoded");
    }
    t.width = static_cast<std::uint32_t>(width);
    t.height = static_cast<std::uint32_t>(height);
    t.rgba.assign(pixels.get(), pixels.get() + std::size_t{4} * t.width * t.height);
    if (texture.sampler >= 0) {
      const auto& sampler = document_.get(document_.model().samplers, texture.sampler, "sampler");
      t.wrap_u = wrap_of(sampler.wrapS);
      t.wrap_v = wrap_of(sampler.wrapT);
      t.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    scene_.textures.push_back(std::move(t));
    return static_cast<std::uint32_t>(scene_.textures.size() - 1);
  }

  std::uint32_t missing(const std::string& what) {
    if (!options_.allow_missing_textures) {
      document_.fail(what, "put it beside the file or allow missing textures");
    }
    document_.warn(what + "; its texture is left out");
    return kNoIndex;
  }

  Document& document_;
  const LoadOptions& options_;
  scene::Scene& scene_;
  std::map<std::pair<int, bool>, std::uint32_t> slots_;
};

// The texture that a member of an extension names, linear.
std::uint32_t extension_texture(Textures& textures, const Value& of, const std::string& key) {
  const double index = number_or(member(of, key), "index", -1);
  return textures.slot(static_cast<int>(std::clamp(index, -1.0, 1e9)), false);
}

void read_extensions(Document& document, Textures& textures, const tinygltf::Material& from,
                     Material& m) {
  const Value& transmission = extension(from.extensions, "KHR_materials_transmission");
  m.transmission = static_cast<float>(number_or(transmission, "transmissionFactor", 0));
  m.transmission_texture = extension_texture(textures, transmission, "transmissionTexture");
  const Value& ior = extension(from.extensions, "KHR_materials_ior");
  m.ior = static_cast<float>(number_or(ior, "ior", 1.5));
  const Value& volume = extension(from.extensions, "KHR_materials_volume");
  m.attenuation_color = color_of(array_of(volume, "attenuationColor"), glm::vec3(1));
  const double distance = number_or(volume, "attenuationDistance", 0);
  // An unlimited distance may be written as infinity or as a huge number: it does not absorb.
  m.attenuation_distance =
      std::isfinite(distance) && distance < 1e30 ? static_cast<float>(distance) : 0;
  // Without thickness the surface bounds a sheet, not a body.
  m.thin = m.transmission > 0 && !(number_or(volume, "thicknessFactor", 0) > 0);
  const Value& coat = extension(from.extensions, "KHR_materials_clearcoat");
  m.clearcoat = static_cast<float>(number_or(coat, "clearcoatFactor", 0));
  m.clearcoat_roughness = static_cast<float>(number_or(coat, "clearcoatRoughnessFactor", 0));
  m.clearcoat_texture = extension_texture(textures, coat, "clearcoatTexture");
  m.clearcoat_roughness_texture = extension_texture(textures, coat, "clearcoatRoughnessTexture");
  if (member(coat, "clearcoatNormalTexture").IsObject()) {
    document.warn("clearcoat normal maps are not applied; coats follow the surface's normals");
  }
  const Value& strength = extension(from.extensions, "KHR_materials_emissive_strength");
  m.emission *= static_cast<float>(number_or(strength, "emissiveStrength", 1));
}

// extras.kind fixes LumiBench's meaning; otherwise the plain corners of glTF's model are the plain
// kinds, which cost less.
void choose_kind(const tinygltf::Material& from, Material& m) {
  const std::string kind = text_or(from.extras, "kind", "");
  const bool plain = m.metallic_roughness_texture == kNoIndex;
  if (kind == "metal") {
    m.kind = scene::MaterialKind::kMetal;
  } else if (kind == "glass") {
    m.kind = scene::MaterialKind::kGlass;
    m.transmission = 1;
    m.thin = false;
  } else if (kind == "emissive") {
    m.kind = scene::MaterialKind::kEmissive;
  } else if (kind == "diffuse") {
    m.kind = scene::MaterialKind::kDiffuse;
  } else if (plain && m.metallic == 0 && m.roughness == 1 && m.transmission == 0) {
    m.kind = scene::MaterialKind::kDiffuse;
  } else {
    m.kind = scene::MaterialKind::kPrincipled;
  }
}

scene::AlphaMode alpha_mode_of(const std::string& mode) {
  return mode == "MASK"    ? scene::AlphaMode::kMask
         : mode == "BLEND" ? scene::AlphaMode::kBlend
                           : scene::AlphaMode::kOpaque;
}

Material read_material(Document& document, Textures& textures, const tinygltf::Material& from,
                       std::size_t index) {
  const auto& pbr = from.pbrMetallicRoughness;
  Material m;
  m.name = from.name.empty() ? std::to_string(index) : from.name;
  m.base_color = color_of(pbr.baseColorFactor, glm::vec3(1));
  m.alpha = pbr.baseColorFactor.size() > 3 ? static_cast<float>(pbr.baseColorFactor[3]) : 1;
  m.metallic = static_cast<float>(pbr.metallicFactor);
  m.roughness = static_cast<float>(pbr.roughnessFactor);
  m.emission = color_of(from.emissiveFactor, glm::vec3(0));
  m.alpha_mode = alpha_mode_of(from.alphaMode);
  m.alpha_cutoff = static_cast<float>(from.alphaCutoff);
  m.double_sided = from.doubleSided;
  read_extensions(document, textures, from, m);
  m.base_texture = textures.slot(pbr.baseColorTexture.index, true);
  m.metallic_roughness_texture = textures.slot(pbr.metallicRoughnessTexture.index, false);
  m.emissive_texture =
      m.emission == glm::vec3(0) ? kNoIndex : textures.slot(from.emissiveTexture.index, true);
  m.normal_texture = textures.slot(from.normalTexture.index, false);
  m.normal_scale = static_cast<float>(from.normalTexture.scale);
  if (from.occlusionTexture.index >= 0) {
    document.warn("occlusion textures are not applied; rays find what is occluded");
  }
  choose_kind(from, m);
  return m;
}

int uv_set_of(Document& document, const tinygltf::Material& from) {
  const auto& pbr = from.pbrMetallicRoughness;
  int set = -1;
  for (const auto& [index, coord] :
       {std::pair(pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord),
        std::pair(pbr.metallicRoughnessTexture.index, pbr.metallicRoughnessTexture.texCoord),
        std::pair(from.normalTexture.index, from.normalTexture.texCoord),
        std::pair(from.emissiveTexture.index, from.emissiveTexture.texCoord)}) {
    if (index >= 0 && set >= 0 && coord != set) {
      document.warn("material '" + from.name +
                    "' uses several texture coordinate sets; only the first is read");
    }
    set = index >= 0 && set < 0 ? coord : set;
  }
  return std::max(set, 0);
}

}  // namespace

std::vector<int> load_materials(Document& document, const LoadOptions& options,
                                scene::Scene& scene) {
  Textures textures(document, options, scene);
  std::vector<int> uv_sets;
  const auto& all = document.model().materials;
  for (std::size_t i = 0; i < all.size(); ++i) {
    scene.materials.push_back(read_material(document, textures, all[i], i));
    uv_sets.push_back(uv_set_of(document, all[i]));
  }
  Material fallback;
  fallback.name = "default";
  fallback.base_color = glm::vec3(0.8F);
  fallback.double_sided = true;
  scene.materials.push_back(fallback);
  uv_sets.push_back(0);
  return uv_sets;
}

UvTransform uv_transform(Document& document, int material) {
  UvTransform t;
  if (material < 0) {
    return t;
  }
  const auto& from = document.get(document.model().materials, material, "material");
  const Value& v =
      extension(from.pbrMetallicRoughness.baseColorTexture.extensions, "KHR_texture_transform");
  if (!v.IsObject()) {
    return t;
  }
  const std::vector<double> offset = array_of(v, "offset");
  const std::vector<double> scale = array_of(v, "scale");
  const double angle = number_or(v, "rotation", 0);
  const double su = scale.size() == 2 ? scale[0] : 1;
  const double sv = scale.size() == 2 ? scale[1] : 1;
  t.m[0][0] = std::cos(angle) * su;
  t.m[0][1] = std::sin(angle) * sv;
  t.m[1][0] = -std::sin(angle) * su;
  t.m[1][1] = std::cos(angle) * sv;
  t.m[0][2] = offset.size() == 2 ? offset[0] : 0;
  t.m[1][2] = offset.size() == 2 ? offset[1] : 0;
  t.identity = false;
  return t;
}

}  // namespace a2rt::gltf
