#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "payload.glsl"
#include "sky.glsl"

layout(location = 0) rayPayloadInEXT PathPayload payload;

void main() {
  payload.t = -1.0;
  payload.lobe = kLobeNone;
  payload.emission = sky(normalize(gl_WorldRayDirectionEXT));
}
