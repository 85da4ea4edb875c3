#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <optional>

#include "gltf/parts.h"

namespace a2rt::gltf {
namespace {

using scene::kNoIndex;

glm::dmat4 from_parts(const glm::dvec3& translation, const glm::dquat& rotation,
                      const glm::dvec3& scale) {
  glm::dmat4 m = glm::mat4_cast(rotation);
  for (int column = 0; column < 3; ++column) {
    m[column] *= scale[column];
  }
  m[3] = glm::dvec4(translation, 1);
  return m;
}

glm::dquat quaternion(double x, double y, double z, double w) {
  const glm::dquat q(w, x, y, z);
  const double length = glm::length(q);
  return length > 0 ? q / length : glm::dquat(1, 0, 0, 0);
}

glm::dmat4 local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) {
    return glm::make_mat4(node.matrix.data());
  }
  const auto& t = node.translation;
  const auto& r = node.rotation;
  const auto& s = node.scale;
  return from_parts(t.size() == 3 ? glm::dvec3(t[0], t[1], t[2]) : glm::dvec3(0),
                    r.size() == 4 ? quaternion(r[0], r[1], r[2], r[3]) : glm::dquat(1, 0, 0, 0),
                    s.size() == 3 ? glm::dvec3(s[0], s[1], s[2]) : glm::dvec3(1));
}

class Walker {
 public:
  Walker(Document& document, const std::vector<int>& uv_sets, scene::Scene& scene)
      : document_(document), uv_sets_(uv_sets), scene_(scene) {}

  void run() {
    const auto& nodes = document_.model().nodes;
    world_.resize(nodes.size());
    const auto& scenes = document_.model().scenes;
    if (scenes.empty()) {
      place_roots(roots_of_file());
    } else {
      const int chosen = document_.model().defaultScene < 0 ? 0 : document_.model().defaultScene;
      const tinygltf::Scene& from = document_.get(scenes, chosen, "scene");
      place_roots(from.nodes);
      load_scene_extras(document_, from, scene_);
    }
    for (const int node : order_) {
      load_node(node);
    }
  }

 private:
  std::vector<int> roots_of_file() const {
    std::vector<bool> child(document_.model().nodes.size(), false);
    for (const auto& node : document_.model().nodes) {
      for (const int c : node.children) {
        if (c >= 0 && static_cast<std::size_t>(c) < child.size()) {
          child[static_cast<std::size_t>(c)] = true;
        }
      }
    }
    std::vector<int> roots;
    for (std::size_t i = 0; i < child.size(); ++i) {
      if (!child[i]) {
        roots.push_back(static_cast<int>(i));
      }
    }
    return roots;
  }

  // World transforms, depth first without recursion: a file decides how deep it is.
  void place_roots(const std::vector<int>& roots) {
    std::vector<std::pair<int, glm::dmat4>> open;
    for (auto it = roots.rbegin(); it != roots.rend(); ++it) {
      open.emplace_back(*it, glm::dmat4(1));
    }
    while (!open.empty()) {
      const auto [index, parent] = open.back();
      open.pop_back();
      const tinygltf::Node& node = document_.get(document_.model().nodes, index, "node");
      auto& world = world_[static_cast<std::size_t>(index)];
      if (world) {
        document_.fail("node " + std::to_string(index) +
                       " is reached twice: a node has one parent at most, and no cycles");
      }
      world = parent * local_transform(node);
      order_.push_back(index);
      for (auto it = node.children.rbegin(); it != node.children.rend(); ++it) {
        open.emplace_back(*it, *world);
      }
    }
  }

  void load_node(int index) {
    const tinygltf::Node& node = document_.model().nodes[static_cast<std::size_t>(index)];
    const glm::dmat4& world = *world_[static_cast<std::size_t>(index)];
    const std::string name = node.name.empty() ? std::to_string(index) : node.name;
    if (node.mesh >= 0) {
      load_mesh_node(node, name, world);
    }
    if (node.camera >= 0) {
      load_camera(node, name, world);
    }
    const tinygltf::Value& light = extension(node.extensions, "KHR_lights_punctual");
    const double number = number_or(light, "light", -1);
    if (number >= 0) {
      load_light(node, static_cast<int>(std::min(number, 1e9)), name, world);
    }
    load_shapes(node, name, world);
  }

  void load_mesh_node(const tinygltf::Node& node, const std::string& name,
                      const glm::dmat4& world) {
    if (node.skin >= 0) {
      // The transform of a skinned node does not count: its joints place it.
      const std::uint32_t mesh =
          add(load_mesh(document_, node.mesh, uv_sets_, joints(node), scene_));
      place(mesh, name, glm::dmat4(1));
      return;
    }
    auto known = meshes_.find(node.mesh);
    if (known == meshes_.end()) {
      known = meshes_.emplace(node.mesh, add(load_mesh(document_, node.mesh, uv_sets_, {}, scene_)))
                  .first;
    }
    const tinygltf::Value& instancing = extension(node.extensions, "EXT_mesh_gpu_instancing");
    if (instancing.IsObject()) {
      place_many(known->second, name, world, member(instancing, "attributes"));
    } else {
      place(known->second, name, world);
    }
  }

  std::uint32_t add(scene::Mesh mesh) {
    scene_.meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
  }

  void place(std::uint32_t mesh, const std::string& name, const glm::dmat4& transform) {
    bool empty = true;
    for (const auto& p : scene_.meshes[mesh].primitives) {
      empty = empty && p.indices.empty();
    }
    if (!empty) {
      scene_.instances.push_back({name, mesh, kNoIndex, transform});
    }
  }

  void place_many(std::uint32_t mesh, const std::string& name, const glm::dmat4& world,
                  const tinygltf::Value& attributes) {
    const auto read = [&](const std::string& key, std::size_t components) {
      const double accessor = number_or(attributes, key, -1);
      return accessor < 0 ? Numbers{}
                          : document_.numbers(static_cast<int>(std::min(accessor, 1e9)), components,
                                              "node '" + name + "', instance " + key);
    };
    const Numbers t = read("TRANSLATION", 3);
    const Numbers r = read("ROTATION", 4);
    const Numbers s = read("SCALE", 3);
    const std::size_t count = std::max({t.count, r.count, s.count});
    for (const Numbers* n : {&t, &r, &s}) {
      if (n->count != 0 && n->count != count) {
        document_.fail("node '" + name + "': its instance attributes differ in length");
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto vec = [&](const Numbers& n, double fallback) {
        return n.count == 0 ? glm::dvec3(fallback) : glm::dvec3(n.at(i, 0), n.at(i, 1), n.at(i, 2));
      };
      const glm::dquat rotation = r.count == 0
                                      ? glm::dquat(1, 0, 0, 0)
                                      : quaternion(r.at(i, 0), r.at(i, 1), r.at(i, 2), r.at(i, 3));
      place(mesh, name, world * from_parts(vec(t, 0), rotation, vec(s, 1)));
    }
  }

  std::vector<glm::dmat4> joints(const tinygltf::Node& node) {
    const tinygltf::Skin& skin = document_.get(document_.model().skins, node.skin, "skin");
    Numbers inverse;
    if (skin.inverseBindMatrices >= 0) {
      inverse = document_.numbers(skin.inverseBindMatrices, 16, "inverse bind matrices");
      if (inverse.count < skin.joints.size()) {
        document_.fail("skin '" + skin.name + "' has fewer inverse bind matrices than joints");
      }
    }
    std::vector<glm::dmat4> matrices;
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
      document_.get(document_.model().nodes, skin.joints[i], "node");
      const auto& world = world_[static_cast<std::size_t>(skin.joints[i])];
      const glm::dmat4 bind =
          inverse.count == 0 ? glm::dmat4(1) : glm::make_mat4(&inverse.values[i * 16]);
      matrices.push_back(world.value_or(glm::dmat4(1)) * bind);
    }
    if (matrices.empty()) {
      document_.fail("skin '" + skin.name + "' has no joints");
    }
    return matrices;
  }

  static glm::vec3 axis(const glm::dmat4& world, const glm::dvec3& direction) {
    const glm::dvec3 d = glm::dvec3(world * glm::dvec4(direction, 0));
    const double length = glm::length(d);
    return length > 0 ? glm::vec3(d / length) : glm::vec3(0);
  }

  void load_camera(const tinygltf::Node& node, const std::string& name, const glm::dmat4& world) {
    const tinygltf::Camera& from = document_.get(document_.model().cameras, node.camera, "camera");
    scene::Camera c;
    c.name = name;
    c.eye = glm::vec3(world[3]);
    c.forward = axis(world, {0, 0, -1});
    c.up = axis(world, {0, 1, 0});
    if (from.type == "orthographic") {
      c.orthographic_height = 2 * static_cast<float>(from.orthographic.ymag);
      if (!(c.orthographic_height > 0)) {
        document_.fail("camera '" + name + "' sees no area: ymag must be above 0");
      }
    } else {
      c.vertical_fov = static_cast<float>(from.perspective.yfov);
    }
    c.aperture = static_cast<float>(number_or(node.extras, "aperture", 0));
    c.focus_distance = static_cast<float>(number_or(node.extras, "focus_distance", 1));
    scene_.cameras.push_back(c);
  }

  void load_light(const tinygltf::Node& node, int index, const std::string& name,
                  const glm::dmat4& world) {
    const tinygltf::Light& from = document_.get(document_.model().lights, index, "light");
    scene::Light light;
    light.name = from.name.empty() ? name : from.name;
    const glm::vec3 color = from.color.size() < 3
                                ? glm::vec3(1)
                                : glm::vec3(from.color[0], from.color[1], from.color[2]);
    light.color = color * static_cast<float>(from.intensity);
    light.position = glm::vec3(world[3]);
    light.range = static_cast<float>(std::max(0.0, from.range));
    const double angle = number_or(node.extras, "angular_diameter", 0);
    light.radius = static_cast<float>(std::max(0.0, number_or(node.extras, "radius", 0)));
    if (from.type == "directional") {
      light.kind = scene::LightKind::kDirectional;
      light.direction = axis(world, {0, 0, 1});
      light.radius = static_cast<float>(std::tan(0.5 * std::clamp(angle, 0.0, 3.0)));
    } else if (from.type == "spot") {
      light.kind = scene::LightKind::kSpot;
      light.direction = axis(world, {0, 0, -1});
      light.inner_angle = static_cast<float>(from.spot.innerConeAngle);
      light.outer_angle = static_cast<float>(from.spot.outerConeAngle);
    } else if (from.type == "point") {
      light.kind = scene::LightKind::kPoint;
    } else {
      document_.fail("light '" + light.name + "' has the unknown type '" + from.type + "'");
    }
    scene_.lights.push_back(light);
  }

  // A2RT_procedural: {"kind": "sphere"|"box", "shapes": [[cx,cy,cz, hx,hy,hz, material], ...]}
  void load_shapes(const tinygltf::Node& node, const std::string& name, const glm::dmat4& world) {
    const tinygltf::Value& from = extension(node.extensions, "A2RT_procedural");
    if (!from.IsObject()) {
      return;
    }
    scene::ShapeSet set;
    set.name = name;
    set.kind = text_or(from, "kind", "sphere") == "box" ? scene::ShapeKind::kBox
                                                        : scene::ShapeKind::kSphere;
    const tinygltf::Value& list = member(from, "shapes");
    for (std::size_t i = 0; list.IsArray() && i < list.ArrayLen(); ++i) {
      const tinygltf::Value& entry = list.Get(static_cast<int>(i));
      double v[7] = {};
      for (std::size_t c = 0; c < 7; ++c) {
        if (!entry.IsArray() || entry.ArrayLen() != 7 ||
            !entry.Get(static_cast<int>(c)).IsNumber()) {
          document_.fail("node '" + name + "': shape " + std::to_string(i) +
                         " must have seven numbers");
        }
        v[c] = entry.Get(static_cast<int>(c)).GetNumberAsDouble();
      }
      if (!(v[6] >= 0 && v[6] < static_cast<double>(document_.model().materials.size()))) {
        document_.fail("node '" + name + "': shape " + std::to_string(i) + " has no such material");
      }
      set.shapes.push_back({glm::vec3(v[0], v[1], v[2]), glm::vec3(v[3], v[4], v[5]),
                            static_cast<std::uint32_t>(v[6])});
    }
    if (!set.shapes.empty()) {
      scene_.shape_sets.push_back(std::move(set));
      scene_.instances.push_back(
          {name, kNoIndex, static_cast<std::uint32_t>(scene_.shape_sets.size() - 1), world});
    }
  }

  Document& document_;
  const std::vector<int>& uv_sets_;
  scene::Scene& scene_;
  std::vector<std::optional<glm::dmat4>> world_;  // set for nodes of the scene
  std::vector<int> order_;
  std::map<int, std::uint32_t> meshes_;
};

glm::vec3 vec3_or(const tinygltf::Value& object, const std::string& key,
                  const glm::vec3& fallback) {
  const std::vector<double> v = array_of(object, key);
  return v.size() == 3 ? glm::vec3(v[0], v[1], v[2]) : fallback;
}

// The file says nothing about a sky: it gets one if nothing else would light it.
bool needs_sky(const scene::Scene& scene) {
  for (const auto& m : scene.materials) {
    if (m.emission != glm::vec3(0)) {
      return false;
    }
  }
  return scene.lights.empty();
}

}  // namespace

void load_nodes(Document& document, const std::vector<int>& uv_sets, scene::Scene& scene) {
  Walker(document, uv_sets, scene).run();
  const auto& scenes = document.model().scenes;
  bool said = false;
  for (const auto& s : scenes) {
    said = said || member(s.extras, "has_sky").IsBool();
  }
  if (!said) {
    scene.sky.present = needs_sky(scene);
  }
}

void load_scene_extras(Document& document, const tinygltf::Scene& from, scene::Scene& scene) {
  const tinygltf::Value& extras = from.extras;
  scene.lumibench = member(extras, "lumibench").IsString();
  scene.sky.present = boolean_or(extras, "has_sky", false);
  const tinygltf::Value& sky = member(extras, "sky");
  scene.sky.bottom = vec3_or(sky, "bottom", scene.sky.bottom);
  scene.sky.top = vec3_or(sky, "top", scene.sky.top);
  const tinygltf::Value& light = member(extras, "light");
  const glm::vec3 direction = vec3_or(light, "direction", scene.sun_direction);
  if (glm::length(direction) > 0) {
    scene.sun_direction = glm::normalize(direction);
  }
  if (member(light, "position").IsArray()) {
    scene::Light sphere;
    sphere.name = "extras.light";
    sphere.kind = scene::LightKind::kSphere;
    sphere.position = vec3_or(light, "position", glm::vec3(0));
    sphere.radius = static_cast<float>(number_or(light, "radius", 10));
    scene.lights.push_back(sphere);
  }
  if (!boolean_or(extras, "complete", true)) {
    const tinygltf::Value& missing = member(extras, "missing_objs");
    document.warn("partial scene: " + std::to_string(missing.IsArray() ? missing.ArrayLen() : 0) +
                  " parts of the original are absent");
  }
}

}  // namespace a2rt::gltf
