#include "effects/analysis.h"

#include <algorithm>
#include <sstream>

#include "glsl/shared.h"

namespace a2rt::effects {
namespace {

using scene::Material;
using scene::MaterialKind;
using scene::Scene;

// Lists of materials stay readable: the first few by name, the rest by number.
constexpr std::size_t kNamed = 6;

class Calls {
 public:
  void add(std::uint32_t bit, const std::string& who) {
    std::vector<std::string>& list = by_bit_[bit];
    if (std::find(list.begin(), list.end(), who) == list.end()) {
      list.push_back(who);
    }
  }
  std::vector<std::string> of(std::uint32_t bit) const {
    const auto it = by_bit_.find(bit);
    if (it == by_bit_.end()) {
      return {};
    }
    std::vector<std::string> list = it->second;
    if (list.size() > kNamed + 1) {
      const std::size_t rest = list.size() - kNamed;
      list.resize(kNamed);
      list.push_back(std::to_string(rest) + " more");
    }
    return list;
  }

 private:
  std::map<std::uint32_t, std::vector<std::string>> by_bit_;
};

// Reflection of a layer of the given roughness (which a texture may scale).
void reflects(Calls& calls, const std::string& who, float roughness) {
  calls.add(roughness == 0 ? gpu::kEffectMirror : gpu::kEffectRough, who);
}

void transmits(Calls& calls, const std::string& who, const Material& m) {
  calls.add(gpu::kEffectRefraction, who);
  if (m.roughness > 0) {
    calls.add(gpu::kEffectRough, who);
  }
  if (m.attenuation_distance > 0 && !m.thin) {
    calls.add(gpu::kEffectVolume, who);
  }
}

// Greatest value of a channel of a texture; 1 without one.
float most(const Scene& scene, std::uint32_t texture, std::size_t channel) {
  if (texture == scene::kNoIndex) {
    return 1;
  }
  const auto& rgba = scene.textures[texture].rgba;
  std::uint8_t value = 0;
  for (std::size_t i = channel; i < rgba.size(); i += 4) {
    value = std::max(value, rgba[i]);
  }
  return static_cast<float>(value) / 255.0F;
}

void principled_calls(Calls& calls, const Scene& scene, const std::string& who, const Material& m) {
  const bool textured = m.metallic_roughness_texture != scene::kNoIndex;
  // What transmits reflects by its own Fresnel term, as part of refraction; the rest has a coat.
  const bool coated = m.transmission < 1 || m.transmission_texture != scene::kNoIndex;
  if (m.metallic > 0 || (coated && m.roughness < 1) || textured) {
    reflects(calls, who, m.roughness);
    if (textured && m.roughness > 0) {
      calls.add(gpu::kEffectMirror, who);  // a texel may be 0
    }
  }
  const bool all_metal = m.metallic >= 1 && !textured;
  if (m.transmission * most(scene, m.transmission_texture, 0) > 0 && !all_metal) {
    transmits(calls, who, m);
  }
  if (!all_metal && coated) {
    calls.add(gpu::kEffectDiffuse, who);
  }
}

void material_calls(Calls& calls, const Scene& scene, const Material& m) {
  const std::string who = "material " + m.name;
  switch (m.kind) {
    case MaterialKind::kDiffuse:
      calls.add(gpu::kEffectDiffuse, who);
      break;
    case MaterialKind::kMetal:
      reflects(calls, who, m.roughness);
      break;
    case MaterialKind::kGlass:
      transmits(calls, who, m);
      break;
    case MaterialKind::kEmissive:
      break;
    case MaterialKind::kPrincipled:
      principled_calls(calls, scene, who, m);
      break;
  }
  if (m.clearcoat * most(scene, m.clearcoat_texture, 0) > 0) {
    calls.add(gpu::kEffectClearcoat, who);
  }
  if (m.emission != glm::vec3(0)) {
    calls.add(gpu::kEffectEmission, who);
  }
  for (const std::uint32_t t :
       {m.base_texture, m.metallic_roughness_texture, m.emissive_texture, m.transmission_texture,
        m.clearcoat_texture, m.clearcoat_roughness_texture}) {
    if (t != scene::kNoIndex) {
      calls.add(gpu::kEffectTextures, who);
    }
  }
  if (m.normal_texture != scene::kNoIndex) {
    calls.add(gpu::kEffectNormalMaps, who);
  }
  if (has_holes(scene, m)) {
    calls.add(gpu::kEffectAlpha, who);
  }
}

void geometry_calls(Calls& calls, const Scene& scene) {
  std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
  for (const scene::Instance& instance : scene.instances) {
    if (instance.mesh != scene::kNoIndex) {
      ++uses[instance.mesh];
      continue;
    }
    const scene::ShapeSet& set = scene.shape_sets[instance.shape_set];
    calls.add(gpu::kEffectProcedural, "shapes " + set.name);
    if (instance.transform != glm::dmat4(1)) {
      calls.add(gpu::kEffectInstancing, "node " + instance.name);
    }
  }
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[i];
    if (uses[i] > 1) {
      calls.add(gpu::kEffectInstancing,
                "mesh " + mesh.name + " (drawn " + std::to_string(uses[i]) + " times)");
    }
    for (const scene::Primitive& p : mesh.primitives) {
      if (uses[i] > 0 && !p.normals.empty()) {
        calls.add(gpu::kEffectNormals, "mesh " + mesh.name);
      }
      const Material& m = scene.materials[p.material];
      if (uses[i] > 0 && !p.indices.empty() && culls(m)) {
        calls.add(gpu::kEffectCulling, "material " + m.name);
      }
    }
  }
}

// Materials of what is placed in the scene; an unused one calls for nothing.
std::vector<bool> used_materials(const Scene& scene) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const scene::Instance& instance : scene.instances) {
    if (instance.mesh != scene::kNoIndex) {
      for (const scene::Primitive& p : scene.meshes[instance.mesh].primitives) {
        used[p.material] = used[p.material] || !p.indices.empty();
      }
    } else {
      for (const scene::Shape& shape : scene.shape_sets[instance.shape_set].shapes) {
        used[shape.material] = true;
      }
    }
  }
  return used;
}

void light_calls(Calls& calls, const Scene& scene, const workloads::WorkloadConfig& workload) {
  bool any = false;
  for (const scene::Light& light : scene.lights) {
    // LumiBench's light sphere lights the shadow workload only: nothing in the scene emits there.
    if (light.kind == scene::LightKind::kSphere && workload.shadow_rays == 0) {
      continue;
    }
    any = true;
    calls.add(light.radius > 0 ? gpu::kEffectSoftShadow : gpu::kEffectShadow,
              "light " + light.name);
  }
  const bool other_light = any || samples_emitters(scene, workload);
  if (workload.sun && !other_light) {
    calls.add(gpu::kEffectShadow, "workload " + workload.name + " (sun from above)");
  }
  if (workload.ao_rays > 0) {
    calls.add(gpu::kEffectAmbientOcclusion, "workload " + workload.name);
  }
  if (scene.sky.present) {
    calls.add(gpu::kEffectSky, "sky of the scene");
  }
}

}  // namespace

bool has_holes(const Scene& scene, const Material& material) {
  if (material.alpha_mode == scene::AlphaMode::kOpaque) {
    return false;
  }
  float least = material.alpha;
  if (material.base_texture != scene::kNoIndex) {
    const scene::Texture& texture = scene.textures[material.base_texture];
    std::uint8_t texel = 255;
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
      texel = std::min(texel, texture.rgba[i]);
    }
    least *= static_cast<float>(texel) / 255.0F;
  }
  return material.alpha_mode == scene::AlphaMode::kMask ? least < material.alpha_cutoff : least < 1;
}

bool culls(const Material& m) {
  const bool body = m.kind == MaterialKind::kGlass || m.transmission > 0;
  return !m.double_sided && !body;
}

bool samples_emitters(const Scene& scene, const workloads::WorkloadConfig& workload) {
  if (!workload.light_sampling || (scene.lumibench && workload.shadow_rays > 0)) {
    return false;
  }
  const std::vector<bool> used = used_materials(scene);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] && scene.materials[i].emission != glm::vec3(0)) {
      return true;
    }
  }
  return false;
}

std::vector<Call> analyse(const Scene& scene, const workloads::WorkloadConfig& workload) {
  Calls found;
  const std::vector<bool> used = used_materials(scene);
  const bool emitters = samples_emitters(scene, workload);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (used[i]) {
      material_calls(found, scene, scene.materials[i]);
      if (emitters && scene.materials[i].emission != glm::vec3(0)) {
        found.add(gpu::kEffectSoftShadow, "material " + scene.materials[i].name);
      }
    }
  }
  geometry_calls(found, scene);
  light_calls(found, scene, workload);
  if (!workload.opaque_geometry) {
    found.add(gpu::kEffectAlpha, "workload " + workload.name);
  }
  std::vector<Call> calls;
  for (const Effect& effect : all()) {
    Call call{effect, false, found.of(effect.bit)};
    call.supported = std::find(workload.effects.begin(), workload.effects.end(), effect.name) !=
                     workload.effects.end();
    calls.push_back(std::move(call));
  }
  return calls;
}

Choice choose(const std::vector<Call>& calls, const std::string& selection) {
  Choice choice;
  for (const Call& call : calls) {
    choice.called_for |= call.needed() ? call.effect.bit : 0;
  }
  if (selection == "all") {
    for (const Call& call : calls) {
      choice.built |= call.supported ? call.effect.bit : 0;
    }
    return choice;
  }
  std::uint32_t wanted = ~std::uint32_t{0};
  if (selection != "auto") {
    wanted = 0;
    std::istringstream list(selection);
    for (std::string name; std::getline(list, name, ',');) {
      wanted |= by_name(name).bit;
    }
  }
  for (const Call& call : calls) {
    if (!call.needed()) {
      continue;
    }
    if ((wanted & call.effect.bit) != 0) {
      choice.built |= call.effect.bit;
    } else if (call.effect.bit != gpu::kEffectInstancing) {
      choice.lacking.push_back(call.effect.name);  // copies look like instances
    }
  }
  return choice;
}

}  // namespace a2rt::effects
