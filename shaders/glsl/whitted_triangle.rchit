#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "payload.glsl"
#include "scatter.glsl"
#include "triangle.glsl"
#include "whitted_payload.glsl"
#include "whitted.glsl"

hitAttributeEXT vec2 attribs;

void main() {
  Surface s = triangle_surface(gl_InstanceCustomIndexEXT + gl_GeometryIndexEXT, attribs);
  shade_recursively(s, normalize(gl_WorldRayDirectionEXT));
}
