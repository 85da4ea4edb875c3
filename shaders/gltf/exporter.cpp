#include "gltf/exporter.h"

#include <stb/stb_image_write.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "a2rt/base/error.h"

namespace a2rt::gltf {
namespace {

using scene::kNoIndex;
using tinygltf::Value;

Value array(const glm::vec3& v) {
  return Value(Value::Array{Value(double{v.x}), Value(double{v.y}), Value(double{v.z})});
}
std::vector<double> list(const glm::vec3& v) { return {v.x, v.y, v.z}; }

const char* kind_name(scene::MaterialKind kind) {
  switch (kind) {
    case scene::MaterialKind::kDiffuse:
      return "diffuse";
    case scene::MaterialKind::kMetal:
      return "metal";
    case scene::MaterialKind::kGlass:
      return "glass";
    case scene::MaterialKind::kEmissive:
      return "emissive";
    case scene::MaterialKind::kPrincipled:
      break;
  }
  return "";
}

int wrap_mode(scene::Wrap wrap) {
  return wrap == scene::Wrap::kClamp    ? TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE
         : wrap == scene::Wrap::kMirror ? TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT
                                        : TINYGLTF_TEXTURE_WRAP_REPEAT;
}

class Exporter {
 public:
  explicit Exporter(const scene::Scene& scene) : scene_(scene) {}

  tinygltf::Model run() {
    model_.asset.version = "2.0";
    model_.asset.generator = "a2rt-render";
    model_.buffers.resize(1);
    model_.scenes.resize(1);
    model_.defaultScene = 0;
    for (const scene::Texture& t : scene_.textures) {
      add_texture(t);
    }
    for (const scene::Material& m : scene_.materials) {
      add_material(m);
    }
    for (const scene::Mesh& m : scene_.meshes) {
      add_mesh(m);
    }
    for (const scene::Camera& c : scene_.cameras) {
      add_camera(c);
    }
    for (const scene::Light& l : scene_.lights) {
      add_light(l);
    }
    for (const scene::Instance& i : scene_.instances) {
      add_instance(i);
    }
    add_scene_extras();
    if (model_.buffers[0].data.empty()) {
      model_.buffers[0].data.resize(4);  // readers refuse an empty binary chunk
    }
    model_.extensionsUsed.assign(used_.begin(), used_.end());
    return std::move(model_);
  }

 private:
  int add_view(const void* data, std::size_t bytes, int target) {
    std::vector<unsigned char>& buffer = model_.buffers[0].data;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = bytes;
    view.target = target;
    const auto* from = static_cast<const unsigned char*>(data);
    buffer.insert(buffer.end(), from, from + bytes);
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size() - 1);
  }

  template <class T>
  int add_accessor(const std::vector<T>& data, int component, int type, int target) {
    tinygltf::Accessor a;
    a.bufferView = add_view(data.data(), data.size() * sizeof(T), target);
    a.componentType = component;
    a.type = type;
    a.count = data.size();
    model_.accessors.push_back(a);
    return static_cast<int>(model_.accessors.size() - 1);
  }

  void add_texture(const scene::Texture& t) {
    std::vector<unsigned char> png;
    const auto append = [](void* to, void* data, int size) {
      auto* bytes = static_cast<std::vector<unsigned char>*>(to);
      const auto* from = static_cast<const unsigned char*>(data);
      bytes->insert(bytes->end(), from, from + size);
    };
    const int width = static_cast<int>(t.width);
    A2RT_CHECK(stbi_write_png_to_func(append, &png, width, static_cast<int>(t.height), 4,
                                      t.rgba.data(), 4 * width) != 0,
               "a texture cannot be encoded");
    tinygltf::Image image;
    image.name = t.name;
    image.mimeType = "image/png";
    image.bufferView = add_view(png.data(), png.size(), 0);
    model_.images.push_back(image);
    tinygltf::Sampler sampler;
    sampler.wrapS = wrap_mode(t.wrap_u);
    sampler.wrapT = wrap_mode(t.wrap_v);
    sampler.magFilter =
        t.nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR;
    model_.samplers.push_back(sampler);
    tinygltf::Texture texture;
    texture.source = static_cast<int>(model_.images.size() - 1);
    texture.sampler = static_cast<int>(model_.samplers.size() - 1);
    model_.textures.push_back(texture);
  }

  static int slot(std::uint32_t texture) {
    return texture == kNoIndex ? -1 : static_cast<int>(texture);
  }

  static void add_slot(Value::Object& values, const std::string& key, std::uint32_t texture) {
    if (texture != kNoIndex) {
      values[key] = Value(Value::Object{{"index", Value(static_cast<int>(texture))}});
    }
  }

  void extend(tinygltf::Material& m, const std::string& name, Value::Object values) {
    m.extensions[name] = Value(std::move(values));
    used_.insert(name);
  }

  void add_material(const scene::Material& from) {
    tinygltf::Material m;
    m.name = from.name;
    m.doubleSided = from.double_sided;
    auto& pbr = m.pbrMetallicRoughness;
    pbr.baseColorFactor = {from.base_color.x, from.base_color.y, from.base_color.z, from.alpha};
    pbr.metallicFactor = from.metallic;
    pbr.roughnessFactor = from.roughness;
    pbr.baseColorTexture.index = slot(from.base_texture);
    pbr.metallicRoughnessTexture.index = slot(from.metallic_roughness_texture);
    m.emissiveTexture.index = slot(from.emissive_texture);
    m.normalTexture.index = slot(from.normal_texture);
    m.normalTexture.scale = from.normal_scale;
    m.alphaMode = from.alpha_mode == scene::AlphaMode::kMask    ? "MASK"
                  : from.alpha_mode == scene::AlphaMode::kBlend ? "BLEND"
                                                                : "OPAQUE";
    m.alphaCutoff = from.alpha_cutoff;
    const std::string kind = kind_name(from.kind);
    if (!kind.empty()) {
      m.extras = Value(Value::Object{{"kind", Value(kind)}});
    }
    const float strength = std::max({from.emission.x, from.emission.y, from.emission.z});
    if (strength > 0) {
      m.emissiveFactor = list(from.emission / strength);
      extend(m, "KHR_materials_emissive_strength", {{"emissiveStrength", Value(double{strength})}});
    }
    if (from.transmission > 0) {
      Value::Object values{{"transmissionFactor", Value(double{from.transmission})}};
      add_slot(values, "transmissionTexture", from.transmission_texture);
      extend(m, "KHR_materials_transmission", std::move(values));
    }
    if (from.ior != 1.5F) {
      extend(m, "KHR_materials_ior", {{"ior", Value(double{from.ior})}});
    }
    if (from.attenuation_distance > 0 || (from.transmission > 0 && !from.thin)) {
      // Any thickness above 0 says that the surface bounds a body.
      Value::Object values{{"thicknessFactor", Value(from.thin ? 0.0 : 1.0)}};
      if (from.attenuation_distance > 0) {
        values["attenuationDistance"] = Value(double{from.attenuation_distance});
        values["attenuationColor"] = array(from.attenuation_color);
      }
      extend(m, "KHR_materials_volume", std::move(values));
    }
    if (from.clearcoat > 0) {
      Value::Object values{{"clearcoatFactor", Value(double{from.clearcoat})},
                           {"clearcoatRoughnessFactor", Value(double{from.clearcoat_roughness})}};
      add_slot(values, "clearcoatTexture", from.clearcoat_texture);
      add_slot(values, "clearcoatRoughnessTexture", from.clearcoat_roughness_texture);
      extend(m, "KHR_materials_clearcoat", std::move(values));
    }
    model_.materials.push_back(m);
  }

  void add_mesh(const scene::Mesh& from) {
    tinygltf::Mesh mesh;
    mesh.name = from.name;
    for (const scene::Primitive& p : from.primitives) {
      if (p.indices.empty()) {
        continue;
      }
      tinygltf::Primitive to;
      to.mode = TINYGLTF_MODE_TRIANGLES;
      to.material = static_cast<int>(p.material);
      to.indices = add_accessor(p.indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
      const int position = add_accessor(p.positions, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                        TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
      glm::vec3 lo = p.positions.front();
      glm::vec3 hi = lo;
      for (const glm::vec3& v : p.positions) {
        lo = glm::min(lo, v);
        hi = glm::max(hi, v);
      }
      model_.accessors.back().minValues = list(lo);  // glTF requires them for positions
      model_.accessors.back().maxValues = list(hi);
      to.attributes["POSITION"] = position;
      if (!p.normals.empty()) {
        to.attributes["NORMAL"] = add_accessor(p.normals, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                               TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
      }
      if (!p.uvs.empty()) {
        to.attributes["TEXCOORD_0"] = add_accessor(
            p.uvs, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, TINYGLTF_TARGET_ARRAY_BUFFER);
      }
      mesh.primitives.push_back(to);
    }
    model_.meshes.push_back(mesh);
  }

  void add_node(tinygltf::Node node) {
    model_.nodes.push_back(std::move(node));
    model_.scenes[0].nodes.push_back(static_cast<int>(model_.nodes.size() - 1));
  }

  // A node whose -z axis is `forward`.
  static tinygltf::Node oriented(const std::string& name, const glm::vec3& at,
                                 const glm::vec3& forward, const glm::vec3& up_hint) {
    const glm::dvec3 z = -glm::normalize(glm::dvec3(forward));
    glm::dvec3 hint(up_hint);
    if (glm::length(glm::cross(hint, z)) < 1e-9) {
      hint = std::abs(z.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    }
    const glm::dvec3 x = glm::normalize(glm::cross(hint, z));
    const glm::dvec3 y = glm::cross(z, x);
    tinygltf::Node node;
    node.name = name;
    node.matrix = {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, at.x, at.y, at.z, 1};
    return node;
  }

  void add_camera(const scene::Camera& c) {
    tinygltf::Camera camera;
    camera.name = c.name;
    if (c.orthographic_height > 0) {
      camera.type = "orthographic";
      camera.orthographic.ymag = camera.orthographic.xmag = 0.5 * double{c.orthographic_height};
      camera.orthographic.znear = 0.01;
      camera.orthographic.zfar = 1e4;
    } else {
      camera.type = "perspective";
      camera.perspective.yfov = c.vertical_fov;
      camera.perspective.znear = 0.01;
    }
    model_.cameras.push_back(camera);
    tinygltf::Node node = oriented(c.name, c.eye, c.forward, c.up);
    node.camera = static_cast<int>(model_.cameras.size() - 1);
    node.extras = Value(Value::Object{{"aperture", Value(double{c.aperture})},
                                      {"focus_distance", Value(double{c.focus_distance})}});
    add_node(node);
  }

  void add_light(const scene::Light& l) {
    if (l.kind == scene::LightKind::kSphere) {
      return;  // goes into the scene's extras
    }
    tinygltf::Light light;
    light.name = l.name;
    light.color = list(l.color);
    light.range = l.range;
    Value::Object extras;
    glm::vec3 forward = l.direction;
    if (l.kind == scene::LightKind::kDirectional) {
      light.type = "directional";
      forward = -l.direction;
      extras["angular_diameter"] = Value(2 * std::atan(double{l.radius}));
    } else {
      light.type = l.kind == scene::LightKind::kSpot ? "spot" : "point";
      light.spot.innerConeAngle = l.inner_angle;
      light.spot.outerConeAngle = l.outer_angle;
      extras["radius"] = Value(double{l.radius});
    }
    tinygltf::Node node = oriented(l.name, l.position, forward, {0, 1, 0});
    node.extras = Value(extras);
    node.extensions["KHR_lights_punctual"] =
        Value(Value::Object{{"light", Value(static_cast<int>(model_.lights.size()))}});
    used_.insert("KHR_lights_punctual");
    model_.lights.push_back(light);
    add_node(node);
  }

  void add_instance(const scene::Instance& i) {
    tinygltf::Node node;
    node.name = i.name;
    if (i.transform != glm::dmat4(1)) {
      for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
          node.matrix.push_back(i.transform[column][row]);
        }
      }
    }
    if (i.mesh != kNoIndex) {
      node.mesh = static_cast<int>(i.mesh);
    } else {
      node.extensions["A2RT_procedural"] = shapes(scene_.shape_sets[i.shape_set]);
      used_.insert("A2RT_procedural");
    }
    add_node(node);
  }

  static Value shapes(const scene::ShapeSet& set) {
    Value::Array entries;
    for (const scene::Shape& s : set.shapes) {
      Value::Array entry;
      for (const glm::vec3& v : {s.centre, s.half_extent}) {
        entry.insert(entry.end(), {Value(double{v.x}), Value(double{v.y}), Value(double{v.z})});
      }
      entry.emplace_back(static_cast<int>(s.material));
      entries.emplace_back(std::move(entry));
    }
    const bool box = set.kind == scene::ShapeKind::kBox;
    return Value(Value::Object{{"kind", Value(std::string(box ? "box" : "sphere"))},
                               {"shapes", Value(std::move(entries))}});
  }

  void add_scene_extras() {
    model_.scenes[0].name = scene_.name;
    Value::Object light{{"direction", array(scene_.sun_direction)}};
    for (const scene::Light& l : scene_.lights) {
      if (l.kind == scene::LightKind::kSphere) {
        light["position"] = array(l.position);
        light["radius"] = Value(double{l.radius});
      }
    }
    model_.scenes[0].extras =
        Value(Value::Object{{"has_sky", Value(scene_.sky.present)},
                            {"sky", Value(Value::Object{{"bottom", array(scene_.sky.bottom)},
                                                        {"top", array(scene_.sky.top)}})},
                            {"light", Value(light)}});
  }

  const scene::Scene& scene_;
  tinygltf::Model model_;
  std::set<std::string> used_;
};

}  // namespace

void save(const scene::Scene& scene, const std::filesystem::path& file) {
  const bool binary = file.extension() == ".glb";
  if (!binary && file.extension() != ".gltf") {
    throw UserError(file.string() + ": name it .glb or .gltf");
  }
  const tinygltf::Model model = Exporter(scene).run();
  // The writer takes the kind from its arguments, but the name must keep its extension.
  const std::filesystem::path temporary =
      file.parent_path() / ("." + std::to_string(getpid()) + "-" + file.filename().string());
  tinygltf::TinyGLTF writer;
  std::error_code error;
  if (!writer.WriteGltfSceneToFile(&model, temporary.string(), true, true, true, binary)) {
    std::filesystem::remove(temporary, error);
    throw UserError("cannot write " + file.string() +
                    ": the folder does not exist or is not writable");
  }
  std::filesystem::rename(temporary, file, error);
  if (error) {
    std::filesystem::remove(temporary, error);
    throw UserError("cannot write " + file.string());
  }
}

}  // namespace a2rt::gltf
