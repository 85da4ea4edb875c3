// Ambient occlusion: short rays into the hemisphere around the normal.
uint blocked_around(PrimaryHit hit, Key key, uint rays) {
  uint count = 0u;
  for (uint i = 0u; i < rays; ++i) {
    if (built(kEffectAmbientOcclusion)) {
      vec3 direction = sphere_direction(random2(key, kDimOcclusion + 2u * i));
      direction = dot(direction, hit.normal) < 0.0 ? -direction : direction;
      count += blocked(hit.position, direction, frame.ao_distance, kRayOcclusion) ? 1u : 0u;
    }
  }
  return count;
}
