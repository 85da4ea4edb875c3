#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "payload.glsl"
#include "scatter.glsl"
#include "triangle.glsl"

layout(location = 0) rayPayloadInEXT PathPayload payload;
hitAttributeEXT vec2 attribs;

void main() {
  Surface s = triangle_surface(gl_InstanceCustomIndexEXT + gl_GeometryIndexEXT, attribs);
  scatter(s, normalize(gl_WorldRayDirectionEXT), payload);
}
