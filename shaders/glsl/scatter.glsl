// What a surface does with a ray. One case per material kind; see shared.h for the kinds.

struct Surface {
  vec3 position;
  vec3 geometric_normal;  // unit, out of the front
  vec3 normal;            // shading, unit
  vec2 uv;
  uint material;
  float t;
  bool triangle;
};

float schlick(float cosine, float r0) {
  float m = clamp(1.0 - cosine, 0.0, 1.0);
  float m2 = m * m;
  return r0 + (1.0 - r0) * m2 * m2 * m;
}
// Unpolarised Fresnel reflectance of a dielectric; eta = n_inside / n_outside of the ray's side.
float fresnel(float cosine, float eta) {
  float sin2 = (1.0 - cosine * cosine) / (eta * eta);
  if (sin2 >= 1.0) {
    return 1.0;
  }
  float cos_t = sqrt(1.0 - sin2);
  float s = (cosine - eta * cos_t) / (cosine + eta * cos_t);
  float p = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  return 0.5 * (s * s + p * p);
}

// Microfacet normal visible from v (Heitz, "Sampling the GGX Distribution of Visible Normals",
// JCGT 2018). alpha = roughness squared.
vec3 visible_normal(vec3 n, vec3 v, float alpha, vec2 u) {
  vec3 t, b;
  basis(n, t, b);
  vec3 local = vec3(dot(v, t), dot(v, b), dot(v, n));
  vec3 vh = normalize(vec3(alpha * local.x, alpha * local.y, local.z));
  float length2 = vh.x * vh.x + vh.y * vh.y;
  vec3 t1 = length2 > 0.0 ? vec3(-vh.y, vh.x, 0.0) * inversesqrt(length2) : vec3(1.0, 0.0, 0.0);
  vec3 t2 = cross(vh, t1);
  vec2 d = disc(u);
  float s = 0.5 * (1.0 + vh.z);
  d.y = (1.0 - s) * sqrt(max(0.0, 1.0 - d.x * d.x)) + s * d.y;
  vec3 nh = d.x * t1 + d.y * t2 + sqrt(max(0.0, 1.0 - dot(d, d))) * vh;
  vec3 h = normalize(vec3(alpha * nh.x, alpha * nh.y, max(1e-6, nh.z)));
  return normalize(t * h.x + b * h.y + n * h.z);
}
float smith_g1(float cosine, float alpha) {
  float a2 = alpha * alpha;
  return 2.0 * cosine / (cosine + sqrt(a2 + (1.0 - a2) * cosine * cosine));
}

// Reflection about n with GGX roughness; weight gets the masking term. False: into the surface.
bool reflect_rough(vec3 n, vec3 v, float roughness, vec2 u, out vec3 direction, out float weight) {
  float alpha = max(roughness * roughness, 1e-4);
  vec3 h = visible_normal(n, v, alpha, u);
  direction = reflect(-v, h);
  float cosine = dot(direction, n);
  weight = cosine > 0.0 ? smith_g1(cosine, alpha) : 0.0;
  return cosine > 0.0;
}

// A reflection: the mirror direction, or a rough one. False: the reflecting effects in question are
// not built or the sample points into the surface.
bool reflect_lobe(vec3 n, vec3 v, float roughness, vec2 u, out vec3 direction, out float weight) {
  weight = 0.0;
  direction = n;
  if (roughness == 0.0) {
    if (built(kEffectMirror)) {
      direction = reflect(-v, n);
      weight = 1.0;
    }
  } else {
    if (built(kEffectRough)) {
      if (!reflect_rough(n, v, roughness, u, direction, weight)) {
        weight = 0.0;
      }
    }
  }
  return weight > 0.0;
}

void go_on(Surface s, vec3 direction, vec3 attenuation, uint lobe, inout PathPayload p) {
  p.direction = direction;
  p.attenuation = attenuation;
  p.lobe = lobe;
  float side = dot(direction, s.geometric_normal);
  p.origin = leave_surface(s.position, side < 0.0 ? -s.geometric_normal : s.geometric_normal);
}

void scatter_diffuse(Surface s, vec3 n, vec3 base, inout PathPayload p) {
  vec3 direction = cosine_direction(n, random2(p.key, kDimScatter));
  // A bent shading normal aims some directions below the true surface: they are folded up, or this
  // point would look for its lights from inside.
  float inside = dot(direction, s.geometric_normal) * dot(n, s.geometric_normal);
  if (inside < 0.0) {
    direction = reflect(direction, s.geometric_normal);
  }
  go_on(s, direction, base, kLobeDiffuse, p);
}

// LumiBench's metal: mirror direction plus a point in a sphere of radius fuzz.
void scatter_metal(Surface s, vec3 n, vec3 d, vec3 base, float fuzz, inout PathPayload p) {
  vec3 r = reflect(d, n);
  if (fuzz > 0.0) {
    if (built(kEffectRough)) {
      vec3 offset = sphere_direction(random2(p.key, kDimScatter)) *
                    pow(random(p.key, kDimScatter + 2u), 1.0 / 3.0);
      r = normalize(r + fuzz * offset);
    } else {
      r = n;
      base = vec3(0.0);
    }
  } else if (!built(kEffectMirror)) {
    base = vec3(0.0);
  }
  if (dot(r, n) > 0.0 && base != vec3(0.0)) {
    go_on(s, r, base, kLobeSpecular, p);
  }
}

// n_inside / n_outside as the ray sees it. Light enters a thin sheet from outside on either side.
float relative_ior(Material m, bool front) { return front || m.thin != 0u ? m.ior : 1.0 / m.ior; }
// The way of light that enters at a normal h; straight on through a thin sheet.
vec3 transmitted(Material m, vec3 d, vec3 h, float eta) {
  return m.thin != 0u ? d : normalize(refract(d, h, 1.0 / eta));
}

// A smooth or rough dielectric: reflects or refracts, by the flip of a Fresnel-weighted coin.
void scatter_glass(Surface s, vec3 n, vec3 d, vec3 base, Material m, bool front,
                   inout PathPayload p) {
  if (!built(kEffectRefraction)) {
    scatter_diffuse(s, n, base, p);
    return;
  }
  p.glass = 1;
  vec3 h = n;
  if (m.roughness > 0.0) {
    if (built(kEffectRough)) {
      h = visible_normal(n, -d, max(m.roughness * m.roughness, 1e-4),
                         random2(p.key, kDimScatter));
    }
  }
  vec3 inside = vec3(1.0);
  if (!front && m.thin == 0u && m.attenuation_distance > 0.0) {
    if (built(kEffectVolume)) {
      inside = pow(max(m.attenuation_color, vec3(1e-6)), vec3(s.t / m.attenuation_distance));
    }
  }
  float eta = relative_ior(m, front);
  float cosine = min(1.0, -dot(d, h));
  float share = fresnel(cosine, eta);
  if (random(p.key, kDimLobe) < share) {
    go_on(s, reflect(d, h), inside, kLobeSpecular, p);
    return;
  }
  go_on(s, transmitted(m, d, h, eta), base * inside, kLobeRefraction, p);
}

// glTF's metallic-roughness model: metal with probability metallic, else a dielectric coat over a
// transmissive or diffuse base.
void scatter_principled(Surface s, vec3 n, vec3 d, vec3 base, Material m, float metallic,
                        float roughness, bool front, inout PathPayload p) {
  float cosine = clamp(-dot(d, n), 0.0, 1.0);
  vec2 u = random2(p.key, kDimScatter);
  float choice = random(p.key, kDimLobe + 1u);
  vec3 direction;
  float weight;
  if (choice < metallic) {
    if (reflect_lobe(n, -d, roughness, u, direction, weight)) {
      float m5 = schlick(dot(normalize(direction - d), direction), 0.0);
      go_on(s, direction, (base + (1.0 - base) * m5) * weight, kLobeSpecular, p);
    }
    return;
  }
  if (random(p.key, kDimLobe + 2u) < m.transmission) {
    scatter_glass(s, n, d, base, m, front, p);
    return;
  }
  float r0 = (m.ior - 1.0) / (m.ior + 1.0);
  float share = schlick(cosine, r0 * r0);
  // At roughness 1 the coat is taken as part of the diffuse base: Lambert, as the simple kinds.
  if (roughness < 1.0) {
    if (random(p.key, kDimLobe) < share) {
      if (reflect_lobe(n, -d, roughness, u, direction, weight)) {
        go_on(s, direction, vec3(weight), kLobeSpecular, p);
        return;
      }
      if (built(kEffectMirror | kEffectRough)) {
        return;
      }
    }
  }
  scatter_diffuse(s, n, base, p);
}

vec3 emitted(Material m, vec2 uv, bool front) {
  vec3 emission = m.emission;
  if (m.emissive_texture >= 0) {
    if (built(kEffectTextures)) {
      emission *= textureLod(textures[nonuniformEXT(m.emissive_texture)], uv, 0.0).rgb;
    }
  }
  bool shines = front || m.single_sided == 0;
  if (shines && emission != vec3(0.0)) {
    if (!built(kEffectEmission)) {
      shines = false;
    }
  }
  return shines ? emission : vec3(0.0);
}

vec3 base_color(Material m, vec2 uv) {
  vec3 base = m.base_color;
  if (m.base_texture >= 0) {
    if (built(kEffectTextures)) {
      base *= textureLod(textures[nonuniformEXT(m.base_texture)], uv, 0.0).rgb;
    }
  }
  return base;
}

// Fills the payload from a surface that a ray of direction d (unit) met.
void scatter(Surface s, vec3 d, inout PathPayload p) {
  Material m = materials[s.material];
  bool front = dot(d, s.geometric_normal) < 0.0;
  // A shading normal that looks away from the ray would scatter into the surface.
  vec3 n = front ? s.normal : -s.normal;
  if (dot(d, n) >= 0.0) {
    n = front ? s.geometric_normal : -s.geometric_normal;
  }
  vec3 base = base_color(m, s.uv);
  p.t = s.t;
  p.material = s.material;
  p.glass = 0;
  p.normal = n;
  p.emission = emitted(m, s.uv, front);
  p.sampled = s.triangle && m.emissive_texture < 0 ? 1u : 0u;
  p.base = base;
  p.attenuation = base;
  p.lobe = kLobeNone;
  p.origin = leave_surface(s.position, front ? s.geometric_normal : -s.geometric_normal);
  if (m.clearcoat > 0.0) {
    if (built(kEffectClearcoat)) {
      if (m.clearcoat_texture >= 0) {
        if (built(kEffectTextures)) {
          m.clearcoat *= textureLod(textures[nonuniformEXT(m.clearcoat_texture)], s.uv, 0.0).r;
        }
      }
      if (m.clearcoat_roughness_texture >= 0) {
        if (built(kEffectTextures)) {
          m.clearcoat_roughness *=
              textureLod(textures[nonuniformEXT(m.clearcoat_roughness_texture)], s.uv, 0.0).g;
        }
      }
      float share = m.clearcoat * schlick(clamp(-dot(d, n), 0.0, 1.0), 0.04);
      if (random(p.key, kDimCoat) < share) {
        vec3 direction;
        float weight;
        if (m.clearcoat_roughness == 0.0) {
          direction = reflect(d, n);
          weight = 1.0;
        } else if (!reflect_rough(n, -d, m.clearcoat_roughness, random2(p.key, kDimCoat + 1u),
                                  direction, weight)) {
          return;
        }
        go_on(s, direction, vec3(weight), kLobeSpecular, p);
        return;
      }
    }
  }
  switch (m.kind) {
    case kMaterialDiffuse:
      scatter_diffuse(s, n, base, p);
      break;
    case kMaterialMetal:
      scatter_metal(s, n, d, base, m.roughness, p);
      break;
    case kMaterialGlass:
      scatter_glass(s, n, d, base, m, front, p);
      break;
    case kMaterialPrincipled: {
      float metallic = m.metallic;
      float roughness = m.roughness;
      if (m.metallic_roughness_texture >= 0) {
        if (built(kEffectTextures)) {
          vec2 mr =
              textureLod(textures[nonuniformEXT(m.metallic_roughness_texture)], s.uv, 0.0).gb;
          roughness *= mr.x;
          metallic *= mr.y;
        }
      }
      if (m.transmission_texture >= 0) {
        if (built(kEffectTextures)) {
          m.transmission *=
              textureLod(textures[nonuniformEXT(m.transmission_texture)], s.uv, 0.0).r;
        }
      }
      scatter_principled(s, n, d, base, m, metallic, roughness, front, p);
      break;
    }
    default:  // a light does not scatter
      break;
  }
}
