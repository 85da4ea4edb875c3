#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "whitted_payload.glsl"
#include "sky.glsl"

layout(location = 0) rayPayloadInEXT WhittedPayload payload;

void main() { payload.color = sky(normalize(gl_WorldRayDirectionEXT)); }
