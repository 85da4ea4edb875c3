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
  return s;
}
