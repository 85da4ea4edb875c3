// The surface of a procedural hit.
const uint kHitSphere = 0;
const uint kHitBox = 1;  // + 2 * axis + (1 if the face looks along the positive axis)

Surface shape_surface(uint geometry_index) {
  Geometry g = geometries[geometry_index];
  Shape shape = shapes[g.first_index + uint(gl_PrimitiveID)];
  Surface s;
  s.t = gl_HitTEXT;
  s.triangle = false;
  s.material = shape.material;
  vec3 local = gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT;
  vec3 n;
  if (gl_HitKindEXT == kHitSphere) {
    n = normalize(local - shape.centre);
    // Back on the sphere: the error of origin + t * direction grows with t, this one does not.
    local = shape.centre + shape.half_extent.x * n;
    s.uv = vec2(atan(n.z, n.x) / (2.0 * kPi) + 0.5, acos(clamp(n.y, -1.0, 1.0)) / kPi);
  } else {
    uint face = gl_HitKindEXT - kHitBox;
    n = vec3(0.0);
    n[face >> 1] = (face & 1u) != 0u ? 1.0 : -1.0;
    vec3 inside = (local - shape.centre) / max(shape.half_extent, vec3(1e-20)) * 0.5 + 0.5;
    s.uv = (face >> 1) == 0u ? inside.zy : (face >> 1) == 1u ? inside.xz : inside.xy;
  }
  s.position = gl_ObjectToWorldEXT * vec4(local, 1.0);
  s.geometric_normal = normalize(n * mat3(gl_WorldToObjectEXT));
  s.normal = s.geometric_normal;
  return s;
}
