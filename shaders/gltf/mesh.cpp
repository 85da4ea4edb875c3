#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <sstream>

#include "gltf/parts.h"

namespace a2rt::gltf {
namespace {

using scene::Primitive;

// What is known about the primitive in hand, for messages.
struct Place {
  const Document& document;
  std::string text;
  [[noreturn]] void fail(const std::string& what, const char* remedy = kRepairFile) const {
    document.fail(text + ": " + what, remedy);
  }
};

int attribute(const tinygltf::Primitive& p, const std::string& name) {
  const auto it = p.attributes.find(name);
  return it == p.attributes.end() ? -1 : it->second;
}

std::vector<glm::vec3> read_vec3(const Document& document, int accessor, const std::string& use) {
  const Numbers n = document.numbers(accessor, 3, use);
  std::vector<glm::vec3> out(n.count);
  for (std::size_t i = 0; i < n.count; ++i) {
    out[i] = glm::vec3(n.at(i, 0), n.at(i, 1), n.at(i, 2));
  }
  return out;
}

std::vector<std::uint32_t> read_indices(const Place& place, const tinygltf::Primitive& from,
                                        std::size_t vertices) {
  std::vector<std::uint32_t> indices;
  if (from.indices < 0) {
    indices.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      indices[i] = static_cast<std::uint32_t>(i);
    }
    return indices;
  }
  const auto& accessor =
      place.document.get(place.document.model().accessors, from.indices, "accessor");
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) {
    place.fail("its indices are floating-point numbers");
  }
  const Numbers n = place.document.numbers(from.indices, 1, place.text + ", indices");
  indices.reserve(n.count);
  for (const double value : n.values) {
    if (!(value >= 0 && value < static_cast<double>(vertices))) {
      place.fail("index " + std::to_string(static_cast<std::int64_t>(value)) + " is outside its " +
                 std::to_string(vertices) + " vertices");
    }
    indices.push_back(static_cast<std::uint32_t>(value));
  }
  return indices;
}

// Strips and fans as lists.
std::vector<std::uint32_t> as_list(int mode, const std::vector<std::uint32_t>& in) {
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    return {in.begin(), in.begin() + static_cast<std::ptrdiff_t>(in.size() / 3 * 3)};
  }
  std::vector<std::uint32_t> out;
  for (std::size_t i = 2; i < in.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      out.insert(out.end(), {in[0], in[i - 1], in[i]});
    } else if (i % 2 == 0) {
      out.insert(out.end(), {in[i - 2], in[i - 1], in[i]});
    } else {
      out.insert(out.end(), {in[i - 1], in[i - 2], in[i]});
    }
  }
  return out;
}

// Vulkan's rule: x = NaN makes a triangle inactive; it says nothing for other non-finite values.
std::uint64_t drop_inactive(const Place& place, Primitive& p) {
  std::vector<std::uint32_t> kept;
  kept.reserve(p.indices.size());
  for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
    bool active = true;
    for (std::size_t c = 0; c < 3; ++c) {
      active = active && !std::isnan(p.positions[p.indices[i + c]].x);
    }
    for (std::size_t c = 0; active && c < 3; ++c) {
      const glm::vec3& v = p.positions[p.indices[i + c]];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
        place.fail("vertex " + std::to_string(p.indices[i + c]) + " is not finite",
                   "repair the file; x = NaN would mark a triangle as inactive");
      }
    }
    if (active) {
      kept.insert(kept.end(), {p.indices[i], p.indices[i + 1], p.indices[i + 2]});
    }
  }
  const std::uint64_t dropped = (p.indices.size() - kept.size()) / 3;
  p.indices = std::move(kept);
  return dropped;
}

void read_normals(Document& document, const Place& place, const tinygltf::Primitive& from,
                  Primitive& p) {
  const int accessor = attribute(from, "NORMAL");
  if (accessor < 0) {
    return;
  }
  p.normals = read_vec3(document, accessor, place.text + ", NORMAL");
  if (p.normals.size() != p.positions.size()) {
    place.fail("it has not as many normals as positions");
  }
  for (glm::vec3& n : p.normals) {
    const float length = glm::length(n);
    if (!(length > 0) || !std::isfinite(length)) {
      document.warn(place.text + ": a normal is zero or not finite; its normals are ignored");
      p.normals.clear();
      return;
    }
    n /= length;
  }
}

void read_uvs(Document& document, const Place& place, const tinygltf::Primitive& from, int set,
              Primitive& p) {
  const int accessor = attribute(from, "TEXCOORD_" + std::to_string(set));
  if (accessor < 0) {
    return;
  }
  const Numbers n = document.numbers(accessor, 2, place.text + ", TEXCOORD");
  if (n.count != p.positions.size()) {
    place.fail("it has not as many texture coordinates as positions");
  }
  const UvTransform t = uv_transform(document, from.material);
  p.uvs.resize(n.count);
  for (std::size_t i = 0; i < n.count; ++i) {
    const double u = n.at(i, 0);
    const double v = n.at(i, 1);
    glm::dvec2 uv(u, v);
    if (!t.identity) {
      uv = {t.m[0][0] * u + t.m[0][1] * v + t.m[0][2], t.m[1][0] * u + t.m[1][1] * v + t.m[1][2]};
    }
    p.uvs[i] = std::isfinite(uv.x) && std::isfinite(uv.y) ? glm::vec2(uv) : glm::vec2(0);
  }
}

// Linear blend skinning at the rest pose.
void skin(const Place& place, const tinygltf::Primitive& from,
          const std::vector<glm::dmat4>& joints, Primitive& p) {
  const int joint_accessor = attribute(from, "JOINTS_0");
  const int weight_accessor = attribute(from, "WEIGHTS_0");
  if (joint_accessor < 0 || weight_accessor < 0) {
    return;
  }
  const Numbers index = place.document.numbers(joint_accessor, 4, place.text + ", JOINTS_0");
  const Numbers weight = place.document.numbers(weight_accessor, 4, place.text + ", WEIGHTS_0");
  if (index.count != p.positions.size() || weight.count != p.positions.size()) {
    place.fail("it has not as many joints and weights as positions");
  }
  for (std::size_t i = 0; i < p.positions.size(); ++i) {
    glm::dmat4 blend(0);
    for (std::size_t c = 0; c < 4; ++c) {
      const double joint = index.at(i, c);
      if (weight.at(i, c) == 0) {
        continue;
      }
      if (!(joint >= 0 && joint < static_cast<double>(joints.size()))) {
        std::ostringstream named;  // any number can stand there
        named << joint;
        place.fail("vertex " + std::to_string(i) + " names joint " + named.str() + " of " +
                   std::to_string(joints.size()));
      }
      blend += weight.at(i, c) * joints[static_cast<std::size_t>(joint)];
    }
    p.positions[i] = glm::vec3(blend * glm::dvec4(glm::dvec3(p.positions[i]), 1));
    const glm::dmat3 linear(blend);
    if (!p.normals.empty() && std::abs(glm::determinant(linear)) > 0) {
      p.normals[i] = glm::vec3(
          glm::normalize(glm::transpose(glm::inverse(linear)) * glm::dvec3(p.normals[i])));
    }
  }
}

}  // namespace

scene::Mesh load_mesh(Document& document, int index, const std::vector<int>& uv_sets,
                      const std::vector<glm::dmat4>& joints, scene::Scene& scene) {
  const tinygltf::Mesh& from = document.get(document.model().meshes, index, "mesh");
  scene::Mesh mesh;
  mesh.name = from.name.empty() ? std::to_string(index) : from.name;
  for (std::size_t number = 0; number < from.primitives.size(); ++number) {
    const tinygltf::Primitive& source = from.primitives[number];
    const Place place{document, "mesh '" + mesh.name + "', primitive " + std::to_string(number)};
    const int mode = source.mode < 0 ? TINYGLTF_MODE_TRIANGLES : source.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      document.warn("mesh '" + mesh.name + "': points and lines are not drawn");
      continue;
    }
    const int position = attribute(source, "POSITION");
    if (position < 0) {
      document.warn("mesh '" + mesh.name + "': a primitive without positions is not drawn");
      continue;
    }
    if (!source.targets.empty()) {
      document.warn("mesh '" + mesh.name + "': morph targets are drawn at weight 0");
    }
    Primitive p;
    p.material = static_cast<std::uint32_t>(uv_sets.size() - 1);
    if (source.material >= 0) {
      document.get(document.model().materials, source.material, "material");
      p.material = static_cast<std::uint32_t>(source.material);
    }
    p.positions = read_vec3(document, position, place.text + ", POSITION");
    read_normals(document, place, source, p);
    read_uvs(document, place, source, uv_sets[p.material], p);
    if (!joints.empty()) {
      skin(place, source, joints, p);
    }
    p.indices = as_list(mode, read_indices(place, source, p.positions.size()));
    scene.inactive_triangles += drop_inactive(place, p);
    mesh.primitives.push_back(std::move(p));
  }
  return mesh;
}

}  // namespace a2rt::gltf
