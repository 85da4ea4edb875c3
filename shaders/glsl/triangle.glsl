// The texel's normal in the frame of the shading normal and the texture axes of the triangle. glTF's
// second axis looks against the direction of growing v.
vec3 mapped_normal(vec3 n, Vertex a, Vertex b, Vertex c, Material m, vec2 uv) {
  vec2 du = b.uv - a.uv;
  vec2 dv = c.uv - a.uv;
  float area = du.x * dv.y - du.y * dv.x;
  mat3 to_world = mat3(gl_ObjectToWorldEXT);
  vec3 e1 = to_world * (b.position - a.position);
  vec3 e2 = to_world * (c.position - a.position);
  float side = area < 0.0 ? -1.0 : 1.0;
  vec3 along_u = side * (e1 * dv.y - e2 * du.y);
  vec3 along_v = side * (e2 * du.x - e1 * dv.x);
  vec3 t = along_u - n * dot(n, along_u);
  float length2 = dot(t, t);
  if (area == 0.0 || !(length2 > 0.0)) {
    return n;  // the triangle has no texture axes
  }
  t *= inversesqrt(length2);
  vec3 up = cross(n, t);
  up = dot(up, along_v) > 0.0 ? -up : up;
  vec3 texel = textureLod(textures[nonuniformEXT(m.normal_texture)], uv, 0.0).xyz * 2.0 - 1.0;
  vec3 mapped = t * (texel.x * m.normal_scale) + up * (texel.y * m.normal_scale) + n * texel.z;
  float size2 = dot(mapped, mapped);
  return size2 > 0.0 ? mapped * inversesqrt(size2) : n;
}

// The surface of a triangle hit; needs the closest-hit builtins and hit attributes.
Surface triangle_surface(uint geometry_index, vec2 attribs) {
  Geometry g = geometries[geometry_index];
  uint first = g.first_index + 3u * uint(gl_PrimitiveID);
  Vertex a = vertices[g.first_vertex + indices[first]];
  Vertex b = vertices[g.first_vertex + indices[first + 1u]];
  Vertex c = vertices[g.first_vertex + indices[first + 2u]];
  vec3 w = vec3(1.0 - attribs.x - attribs.y, attribs.x, attribs.y);
  Surface s;
  s.t = gl_HitTEXT;
  s.triangle = true;
  vec3 local = a.position * w.x + b.position * w.y + c.position * w.z;
  s.position = gl_ObjectToWorldEXT * vec4(local, 1.0);
  // Normals go by the inverse transpose; its sign keeps the front of a mirrored instance.
  vec3 face = cross(b.position - a.position, c.position - a.position);
  s.geometric_normal = normalize(face * mat3(gl_WorldToObjectEXT));
  s.normal = s.geometric_normal;
  if ((g.flags & kGeometrySmooth) != 0) {
    if (built(kEffectNormals)) {
      vec3 shading = a.normal * w.x + b.normal * w.y + c.normal * w.z;
      s.normal = normalize(shading * mat3(gl_WorldToObjectEXT));
      if (dot(s.normal, s.geometric_normal) < 0.0) {
        s.normal = -s.normal;
      }
    }
  }
  s.uv = a.uv * w.x + b.uv * w.y + c.uv * w.z;
  s.material = g.material;
  if ((g.flags & kGeometryNormalMap) != 0) {
    if (built(kEffectNormalMaps)) {
      s.normal = mapped_normal(s.normal, a, b, c, materials[g.material], s.uv);
    }
  }
  return s;
}
