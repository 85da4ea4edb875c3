#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "payload.glsl"
#include "scatter.glsl"
#include "shape.glsl"

layout(location = 0) rayPayloadInEXT PathPayload payload;

void main() {
  Surface s = shape_surface(gl_InstanceCustomIndexEXT + gl_GeometryIndexEXT);
  scatter(s, normalize(gl_WorldRayDirectionEXT), payload);
}
