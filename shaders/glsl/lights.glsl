// Direct light at a diffuse point: every light of the file, and one sample of the emitters.

// A direction within the cone of half-angle tangent `radius` around `axis`.
vec3 cone_direction(vec3 axis, float radius, vec2 u) {
  vec3 t, b;
  basis(axis, t, b);
  vec2 d = radius * disc(u);
  return normalize(axis + t * d.x + b * d.y);
}

// Irradiance over pi from one light of the file, shadow ray included.
vec3 light_from(Light light, vec3 p, vec3 n, vec2 u) {
  vec3 direction = light.direction;
  float distance_to = frame.t_max;
  float strength = 1.0;
  if (light.kind == kLightDirectional) {
    if (light.radius > 0.0) {
      if (built(kEffectSoftShadow)) {
        direction = cone_direction(light.direction, light.radius, u);
      }
    }
  } else {
    vec3 target = light.position;
    if (light.radius > 0.0) {
      if (built(kEffectSoftShadow)) {
        target += light.radius * sphere_direction(u);
      }
    }
    vec3 towards = target - p;
    float d2 = dot(towards, towards);
    distance_to = sqrt(d2);
    direction = towards / distance_to;
    strength = 1.0 / max(d2, 1.0e-12);
    if (light.range > 0.0) {
      float x = distance_to / light.range;
      strength *= clamp(1.0 - x * x * x * x, 0.0, 1.0);
    }
    if (light.kind == kLightSpot) {
      float c = dot(-direction, light.direction);
      float edge = clamp((c - light.cos_outer) / max(1.0e-4, light.cos_inner - light.cos_outer),
                         0.0, 1.0);
      strength *= edge * edge;
    }
  }
  float cosine = dot(n, direction);
  if (cosine <= 0.0 || strength <= 0.0) {
    return vec3(0.0);
  }
  if (blocked(p, direction, distance_to, kRayShadow)) {
    return vec3(0.0);
  }
  return light.color * (strength * cosine / kPi);
}

// The emitter that a number in [0, 1) picks, by power.
uint pick_emitter(float choice) {
  uint lo = 0u;
  uint hi = frame.emitter_count - 1u;
  while (lo < hi) {
    uint middle = (lo + hi) / 2u;
    if (emitters[middle].cumulative <= choice) {
      lo = middle + 1u;
    } else {
      hi = middle;
    }
  }
  return lo;
}
vec3 point_on(Emitter e, vec2 u) {
  float root = sqrt(u.x);
  return e.origin + e.edge1 * (1.0 - root) + e.edge2 * (u.y * root);
}
vec3 emitter_point(float choice, vec2 u) { return point_on(emitters[pick_emitter(choice)], u); }

// Irradiance over pi from one point on one emitting triangle, chosen by power.
vec3 light_from_emitters(vec3 p, vec3 n, Key key) {
  Emitter e = emitters[pick_emitter(random(key, kDimLight))];
  vec3 target = point_on(e, random2(key, kDimLight + 1u));
  vec3 towards = target - p;
  float d2 = dot(towards, towards);
  float distance_to = sqrt(d2);
  vec3 direction = towards / distance_to;
  vec3 face = cross(e.edge1, e.edge2);  // twice the area long
  float cosine = dot(n, direction);
  float facing = -dot(face, direction) * 0.5;  // cosine times the area
  float cosine_light = e.single_sided != 0u ? facing : abs(facing);
  if (cosine <= 0.0 || cosine_light <= 0.0) {
    return vec3(0.0);
  }
  // Stop short of the emitter itself.
  if (blocked(p, direction, distance_to * 0.9999, kRayShadow)) {
    return vec3(0.0);
  }
  return e.emission * (cosine * cosine_light / (d2 * e.probability * kPi));
}

vec3 direct_light(vec3 p, vec3 n, Key key) {
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < frame.light_count; ++i) {
    Light light = lights[i];
    if (light.kind != kLightSphere) {
      if (built(kEffectShadow | kEffectSoftShadow)) {
        sum += light_from(light, p, n, random2(key, kDimLight + 4u + 2u * i));
      }
    }
  }
  if (frame.emitter_count > 0u && frame.light_sampling != 0u) {
    if (built(kEffectSoftShadow)) {
      sum += light_from_emitters(p, n, key);
    }
  }
  return sum;
}
