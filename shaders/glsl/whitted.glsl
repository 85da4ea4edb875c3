// The body of the recursive closest-hit shaders: reflected, refracted and shadow rays are traced
// from here. Everything read from builtins is in `s` before the first trace, because a driver may
// not restore builtins after a nested one.
layout(location = 0) rayPayloadInEXT WhittedPayload payload;
layout(location = 1) rayPayloadEXT uint occluded;
layout(location = 2) rayPayloadEXT WhittedPayload child;

bool blocked(vec3 origin, vec3 direction, float t_max, uint kind) {
  count_ray(kind);
  occluded = 1;
  traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0,
              0, 1, origin, frame.t_min, direction, t_max, 1);
  return occluded != 0;
}
#include "lights.glsl"
#include "ambient.glsl"

vec3 follow(PathPayload p, uint depth, uint kind) {
  if (depth + 1u >= frame.max_bounces) {
    return vec3(0.0);
  }
  child.depth = depth + 1u;
  child.key = branch(p.key, kind);
  count_ray(kind);
  traceRayEXT(tlas, seeing_flags(), 0xff, 0, 0, 0, p.origin, frame.t_min, p.direction,
              frame.t_max, 2);
  return child.color;
}

void shade_recursively(Surface s, vec3 d) {
  uint depth = payload.depth;
  PathPayload p;
  p.key = payload.key;
  scatter(s, d, p);
  vec3 color = p.emission;
  if (p.glass != 0u) {
    // Both branches of the dielectric, weighted by Fresnel, instead of one by chance.
    Material m = materials[s.material];
    bool front = dot(d, s.geometric_normal) < 0.0;
    float eta = relative_ior(m, front);
    float share = fresnel(min(1.0, -dot(d, p.normal)), eta);
    vec3 weight = p.attenuation;
    go_on(s, reflect(d, p.normal), weight, kLobeSpecular, p);
    color += share * weight * follow(p, depth, kRayReflection);
    if (share < 1.0) {
      go_on(s, transmitted(m, d, p.normal, eta), weight, kLobeRefraction, p);
      color += (1.0 - share) * weight * follow(p, depth, kRayRefraction);
    }
  } else if (p.lobe == kLobeSpecular) {
    color += p.attenuation * follow(p, depth, kRayReflection);
  } else if (p.lobe == kLobeDiffuse) {
    color += p.attenuation * local_light(p.origin, p.normal, p.key);
  }
  payload.color = color;
}
