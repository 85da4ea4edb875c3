layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;
layout(set = 0, binding = 1, std430) buffer Picture { uint pixels[]; };
layout(set = 0, binding = 2, std430) buffer More { float more[]; };
layout(set = 0, binding = 3) uniform accelerationStructureEXT second;

uint hash(uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

vec3 hash_color(uint x) {
  uint h = hash(x);
  return vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0;
}

uint pack(vec3 color) { return packUnorm4x8(vec4(color, 1.0)); }

vec3 camera_direction(uvec2 pixel, uvec2 size) {
  vec2 place = (vec2(pixel) + 0.37) / vec2(size) * 2.0 - 1.0;
  return normalize(vec3(place * vec2(1.2, 0.8), -2.0));
}
const vec3 kCamera = vec3(0.013, 0.021, 3.0);
