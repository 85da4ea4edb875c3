// The shape an intersection shader is asked about.
Shape shape_of_candidate() {
  Geometry g = geometries[gl_InstanceCustomIndexEXT + gl_GeometryIndexEXT];
  return shapes[g.first_index + uint(gl_PrimitiveID)];
}
