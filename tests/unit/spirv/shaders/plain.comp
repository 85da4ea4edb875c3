#version 460
layout(local_size_x = 8) in;
layout(set = 0, binding = 1) buffer Out { vec4 values[]; } result;
void main() { result.values[gl_GlobalInvocationID.x] = vec4(1.0); }
