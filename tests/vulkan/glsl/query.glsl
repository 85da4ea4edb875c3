// Runs one ray query with candidates of both kinds; the color of what it found.
vec3 query_color(uvec2 pixel, uvec2 size) {
  vec3 direction = camera_direction(pixel, size);
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene, gl_RayFlagsNoneEXT, 0xff, kCamera, 0.001, direction, 100.0);
  while (rayQueryProceedEXT(query)) {
    if (rayQueryGetIntersectionTypeEXT(query, false) ==
        gl_RayQueryCandidateIntersectionTriangleEXT) {
      vec2 place = rayQueryGetIntersectionBarycentricsEXT(query, false);
      if (fract(place.x * 5.0 + place.y * 3.0) > 0.4) {
        rayQueryConfirmIntersectionEXT(query);
      }
    }
  }
  if (rayQueryGetIntersectionTypeEXT(query, true) ==
      gl_RayQueryCommittedIntersectionNoneEXT) {
    return vec3(0.1, 0.2, 0.3 + 0.2 * direction.y);
  }
  return hash_color(rayQueryGetIntersectionPrimitiveIndexEXT(query, true)) * 0.6 +
         0.1 * fract(rayQueryGetIntersectionTEXT(query, true));
}
