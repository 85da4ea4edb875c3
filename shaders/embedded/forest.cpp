// A forest: three trees and a tuft of grass, placed many times; leaves are masked cards. One unit
// is a metre, y is up.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "embedded/embedded.h"
#include "scene/mesh_builder.h"

namespace a2rt::embedded {
namespace {

using glm::vec3;
using scene::Primitive;
using scene::Random;

constexpr float kTau = 6.2831853F;

// Rolling ground with a hollow path along z.
float ground_height(float x, float z) {
  const float path =
      std::exp(-0.08F * (x - 1.5F * std::sin(0.12F * z)) * (x - 1.5F * std::sin(0.12F * z)));
  return 0.6F * std::sin(0.11F * x + 0.4F) * std::cos(0.09F * z) + 0.25F * std::sin(0.31F * z) -
         0.5F * path;
}

struct Rgba {
  float r, g, b, a;
};

void put(scene::Texture& t, std::uint32_t x, std::uint32_t y, const Rgba& c) {
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0F, 1.0F)));
  };
  std::uint8_t* p = &t.rgba[4 * (std::size_t{y} * t.width + x)];
  p[0] = byte(c.r);
  p[1] = byte(c.g);
  p[2] = byte(c.b);
  p[3] = byte(c.a);
}

scene::Texture blank(const std::string& name, std::uint32_t size, const Rgba& color) {
  scene::Texture t;
  t.name = name;
  t.width = t.height = size;
  t.rgba.resize(std::size_t{4} * size * size);
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      put(t, x, y, color);
    }
  }
  return t;
}

// One pointed leaf with a midrib, painted from `at` in direction `angle`.
void paint_leaf(scene::Texture& t, float at_x, float at_y, float angle, float length, float shade) {
  const float dx = std::cos(angle);
  const float dy = std::sin(angle);
  for (std::uint32_t y = 0; y < t.height; ++y) {
    for (std::uint32_t x = 0; x < t.width; ++x) {
      const float px = static_cast<float>(x) + 0.5F - at_x;
      const float py = static_cast<float>(y) + 0.5F - at_y;
      const float along = (px * dx + py * dy) / length;
      const float across = (px * dy - py * dx) / length;
      if (along < 0 || along > 1) {
        continue;
      }
      const float half_width = 0.30F * std::sin(3.14159265F * std::pow(along, 0.75F));
      if (std::abs(across) > half_width) {
        continue;
      }
      const float rib = std::abs(across) < 0.02F ? 1.25F : 1.0F;
      const float vein = 1 + 0.08F * std::sin(40 * (along - std::abs(across)));
      const float light = shade * rib * vein;
      put(t, x, y, {0.55F * light, 0.74F * light, 0.28F * light, 1});
    }
  }
}

scene::Texture leaf_texture() {
  scene::Texture t = blank("leaves", 128, {0.52F, 0.70F, 0.26F, 0});
  t.wrap_u = t.wrap_v = scene::Wrap::kClamp;
  Random random(7);
  for (int i = 0; i < 11; ++i) {
    const float angle = kTau * (static_cast<float>(i) / 11 + 0.05F * random.next());
    const float start = random.between(2, 14);
    paint_leaf(t, 64 + start * std::cos(angle), 64 + start * std::sin(angle), angle,
               random.between(34, 48), random.between(0.75F, 1.2F));
  }
  return t;
}

scene::Texture grass_texture() {
  scene::Texture t = blank("grass", 128, {0.50F, 0.64F, 0.25F, 0});
  t.wrap_u = t.wrap_v = scene::Wrap::kClamp;
  Random random(11);
  for (int blade = 0; blade < 26; ++blade) {
    const float root = random.between(8, 120);
    const float lean = random.between(-22, 22);
    const float height = random.between(55, 126);
    const float shade = random.between(0.7F, 1.25F);
    for (float y = 0; y < height; y += 0.5F) {
      const float h = y / height;
      const float centre = root + lean * h * h;
      const float half = 2.6F * (1 - h) + 0.3F;
      for (float x = centre - half; x <= centre + half; x += 0.5F) {
        if (x >= 0 && x < 128) {
          const float light = shade * (0.6F + 0.5F * h);
          put(t, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(127 - y),
              {0.56F * light, 0.70F * light, 0.28F * light, 1});
        }
      }
    }
  }
  return t;
}

scene::Texture bark_texture() {
  scene::Texture t = blank("bark", 64, {0, 0, 0, 1});
  Random random(5);
  for (std::uint32_t x = 0; x < 64; ++x) {
    const float ridge = 0.75F + 0.25F * std::sin(kTau * 5 * static_cast<float>(x) / 64);
    for (std::uint32_t y = 0; y < 64; ++y) {
      const float crack =
          0.85F +
          0.15F * std::sin(kTau * (static_cast<float>(y) / 32 + static_cast<float>(x % 13) / 13));
      const float v = ridge * crack * random.between(0.8F, 1.0F);
      put(t, x, y, {0.52F * v, 0.42F * v, 0.33F * v, 1});
    }
  }
  return t;
}

// A card: one quad centred at `at`, spanned by two half edges.
void add_card(Primitive& p, const vec3& at, const vec3& u, const vec3& v) {
  scene::add_quad(p, at - u - v, 2.0F * u, 2.0F * v);
}

vec3 random_direction(Random& random) {
  const float z = random.between(-1, 1);
  const float phi = kTau * random.next();
  const float r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), z, r * std::sin(phi)};
}

struct TreeShape {
  float height, crown_start, crown_width, leaf_size;
  int branches, leaves_per_branch;
};

// Trunk in three bent pieces, branches around it, cards along the branches.
std::vector<Primitive> make_tree(Random& random, const TreeShape& shape, std::uint32_t bark,
                                 std::uint32_t leaf) {
  Primitive wood, leaves;
  wood.material = bark;
  leaves.material = leaf;
  std::vector<vec3> spine = {{0, -0.3F, 0}};
  constexpr int kPieces = 5;
  for (int i = 1; i <= kPieces; ++i) {
    const float h = static_cast<float>(i) / kPieces;
    spine.push_back({random.between(-0.15F, 0.15F) * h * shape.height * 0.25F, h * shape.height,
                     random.between(-0.15F, 0.15F) * h * shape.height * 0.25F});
  }
  const float root = 0.035F * shape.height;
  const auto radius_at = [&](float h) { return root * (1 - 0.85F * h); };
  for (int i = 0; i < kPieces; ++i) {
    const auto piece = static_cast<std::size_t>(i);
    scene::add_tube(wood, spine[piece], spine[piece + 1],
                    radius_at(static_cast<float>(i) / kPieces),
                    radius_at(static_cast<float>(i + 1) / kPieces), 9);
  }
  const auto spine_at = [&](float h) {
    const float at = h * kPieces;
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(at), kPieces - 1);
    return glm::mix(spine[i], spine[i + 1], at - static_cast<float>(i));
  };
  for (int b = 0; b < shape.branches; ++b) {
    const float share = (static_cast<float>(b) + 0.5F) / static_cast<float>(shape.branches);
    const float h = shape.crown_start + (0.98F - shape.crown_start) * share;
    const float phi = 2.399963F * static_cast<float>(b) + 0.5F * random.next();
    const float bulge = std::sin(3.14159265F * (0.18F + 0.8F * share));
    const float length = shape.crown_width * bulge * random.between(0.8F, 1.15F);
    const vec3 from = spine_at(h);
    const vec3 out =
        glm::normalize(vec3(std::cos(phi), random.between(0.15F, 0.55F), std::sin(phi)));
    const vec3 tip = from + length * out;
    scene::add_tube(wood, from, tip, 0.45F * radius_at(h), 0.1F * radius_at(h) + 0.004F, 5);
    for (int l = 0; l < shape.leaves_per_branch; ++l) {
      const float along = random.between(0.3F, 1.08F);
      const vec3 at =
          from + along * (tip - from) + 0.16F * shape.crown_width * random_direction(random);
      const vec3 u = random_direction(random);
      const vec3 v = glm::normalize(glm::cross(u, random_direction(random) + vec3(0, 0.3F, 0)));
      const float size = shape.leaf_size * random.between(0.7F, 1.2F);
      add_card(leaves, at, size * u, size * v);
    }
  }
  leaves.normals.clear();  // cards are flat
  return {wood, leaves};
}

std::vector<Primitive> make_tuft(Random& random, std::uint32_t material) {
  Primitive p;
  p.material = material;
  for (int i = 0; i < 5; ++i) {
    const float phi = kTau * (static_cast<float>(i) / 5 + 0.1F * random.next());
    const vec3 u = 0.30F * vec3(std::cos(phi), 0, std::sin(phi));
    const vec3 at{random.between(-0.18F, 0.18F), 0.19F, random.between(-0.18F, 0.18F)};
    const vec3 v{random.between(-0.05F, 0.05F), -0.22F, random.between(-0.05F, 0.05F)};
    add_card(p, at, u, v);
  }
  p.normals.clear();
  return {p};
}

Primitive make_ground(std::uint32_t material) {
  Primitive p;
  p.material = material;
  constexpr std::uint32_t kCells = 72;
  constexpr float kHalf = 60;
  for (std::uint32_t i = 0; i <= kCells; ++i) {
    for (std::uint32_t j = 0; j <= kCells; ++j) {
      const float x = kHalf * (2 * static_cast<float>(j) / kCells - 1);
      const float z = kHalf * (2 * static_cast<float>(i) / kCells - 1);
      constexpr float kStep = 0.1F;
      const float slope_x = ground_height(x + kStep, z) - ground_height(x - kStep, z);
      const float slope_z = ground_height(x, z + kStep) - ground_height(x, z - kStep);
      p.positions.emplace_back(x, ground_height(x, z), z);
      p.normals.push_back(glm::normalize(vec3(-slope_x, 2 * kStep, -slope_z)));
    }
  }
  constexpr std::uint32_t kRow = kCells + 1;
  for (std::uint32_t i = 0; i < kCells; ++i) {
    for (std::uint32_t j = 0; j < kCells; ++j) {
      const std::uint32_t a = i * kRow + j;
      p.indices.insert(p.indices.end(), {a, a + kRow, a + 1, a + 1, a + kRow, a + kRow + 1});
    }
  }
  return p;
}

std::uint32_t add_leafy(scene::Scene& s, const std::string& name, const vec3& tint,
                        scene::Texture texture) {
  scene::Material m = scene::diffuse(name, tint);
  m.alpha_mode = scene::AlphaMode::kMask;
  m.alpha_cutoff = 0.5F;
  m.base_texture = static_cast<std::uint32_t>(s.textures.size());
  s.textures.push_back(std::move(texture));
  return add_material(s, m);
}

void plant(scene::Scene& s, std::uint32_t mesh, const std::string& name, float x, float z,
           float scale, float turn) {
  scene::Instance instance;
  instance.name = name;
  instance.mesh = mesh;
  glm::dmat4 m = glm::translate(glm::dmat4(1), glm::dvec3(x, ground_height(x, z), z));
  m = glm::rotate(m, static_cast<double>(turn), glm::dvec3(0, 1, 0));
  instance.transform = glm::scale(m, glm::dvec3(static_cast<double>(scale)));
  s.instances.push_back(instance);
}

std::uint32_t add_mesh(scene::Scene& s, const std::string& name, std::vector<Primitive> parts) {
  s.meshes.push_back({name, std::move(parts)});
  return static_cast<std::uint32_t>(s.meshes.size() - 1);
}

scene::Scene make_forest() {
  scene::Scene s;
  Random random(2024);
  scene::Material bark_material = scene::diffuse("bark", {0.75F, 0.7F, 0.65F});
  bark_material.base_texture = 0;
  s.textures.push_back(bark_texture());
  const auto bark = add_material(s, bark_material);
  const auto soil = add_material(s, scene::diffuse("soil", {0.22F, 0.22F, 0.09F}));
  const auto green = add_leafy(s, "leaves green", {0.9F, 1.0F, 0.7F}, leaf_texture());
  scene::Material gold_material = s.materials[green];
  gold_material.name = "leaves gold";
  gold_material.base_color = {2.0F, 1.05F, 0.5F};
  const auto gold = add_material(s, gold_material);
  const auto grass = add_leafy(s, "grass", {0.9F, 1.0F, 0.75F}, grass_texture());

  place(s, "ground", {make_ground(soil)});
  const std::uint32_t trees[] = {
      add_mesh(s, "oak", make_tree(random, {7.5F, 0.28F, 3.0F, 0.42F, 34, 20}, bark, green)),
      add_mesh(s, "birch", make_tree(random, {9.0F, 0.34F, 1.9F, 0.36F, 36, 14}, bark, gold)),
      add_mesh(s, "sapling", make_tree(random, {3.2F, 0.2F, 1.3F, 0.3F, 18, 12}, bark, green))};
  const std::uint32_t tuft = add_mesh(s, "tuft", make_tuft(random, grass));

  // Trees on a jittered grid, none on the path and none in front of the camera.
  for (int i = -9; i <= 9; ++i) {
    for (int j = -9; j <= 9; ++j) {
      const float x = 4.6F * static_cast<float>(j) + random.between(-1.7F, 1.7F);
      const float z = 4.6F * static_cast<float>(i) + random.between(-1.7F, 1.7F);
      const float pick = random.next();
      const float scale = random.between(0.8F, 1.25F);
      const float turn = kTau * random.next();
      const float from_path = std::abs(x - 1.5F * std::sin(0.12F * z));
      const bool near_camera = z > 13 && z < 32 && std::abs(x) < 4.5F;
      if (from_path > 2.4F && !near_camera) {
        const std::uint32_t kind = pick < 0.5F ? 0 : pick < 0.78F ? 1 : 2;
        plant(s, trees[kind], "tree", x, z, scale, turn);
      }
    }
  }
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 30; ++j) {
      const float z = 24.0F - 0.85F * static_cast<float>(i) + random.between(-0.4F, 0.4F);
      const float x = 0.8F * (static_cast<float>(j) - 14.5F) + random.between(-0.4F, 0.4F);
      const float turn = kTau * random.next();
      const float scale = random.between(0.7F, 1.7F);
      if (std::abs(x - 1.5F * std::sin(0.12F * z)) > 0.9F + 0.8F * random.next()) {
        plant(s, tuft, "tuft", x, z, scale, turn);
      }
    }
  }
  scene::Light sun;
  sun.name = "sun";
  sun.direction = glm::normalize(vec3(-0.55F, 0.62F, 0.32F));
  sun.color = vec3(6.6F, 5.6F, 4.2F);
  sun.radius = 0.012F;
  s.lights.push_back(sun);
  s.sky.present = true;
  s.sky.bottom = {1.15F, 1.18F, 1.20F};
  s.sky.top = {0.36F, 0.60F, 1.05F};
  s.cameras.push_back(scene::look_at("path", {0.4F, 1.9F, 25}, {0.2F, 2.6F, 0}, 46));
  return s;
}

const RegisterScene kForest{"forest", "instanced trees with alpha-masked leaves, sun and sky",
                            make_forest};

}  // namespace
}  // namespace a2rt::embedded
