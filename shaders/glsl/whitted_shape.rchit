#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "payload.glsl"
#include "scatter.glsl"
#include "shape.glsl"
#include "whitted_payload.glsl"
#include "whitted.glsl"


void main() {
  Surface s = shape_surface(gl_InstanceCustomIndexEXT + gl_GeometryIndexEXT);
  shade_recursively(s, normalize(gl_WorldRayDirectionEXT));
}
