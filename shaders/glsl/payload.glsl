// Payload of the rays that are followed in a loop: closest-hit fills it, ray generation reads it.

// What the surface did with the ray.
const uint kLobeNone = 0;      // absorbed, or a light
const uint kLobeDiffuse = 1;   // direct light may be gathered at this point
const uint kLobeSpecular = 2;  // mirror, rough reflection
const uint kLobeRefraction = 3;

// What the ray that a lobe sends on is counted as.
uint ray_kind(uint lobe) {
  return lobe == kLobeDiffuse ? kRayBounce : lobe == kLobeSpecular ? kRayReflection : kRayRefraction;
}

struct PathPayload {
  vec3 origin;  // of the next ray
  float t;      // of the hit; -1: miss
  vec3 direction;
  uint lobe;
  vec3 attenuation;
  Key key;  // in: the random numbers of this bounce
  vec3 emission;
  uint material;
  vec3 normal;  // shading normal on the ray's side
  uint glass;   // 1: the surface transmits
  vec3 base;    // colour of the surface before scattering
  uint sampled;  // 1: shadow rays to emitters account for this emission
};
