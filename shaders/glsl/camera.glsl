// Primary rays, and the sum of a pixel's samples.

void primary_ray(uvec2 pixel, uvec2 size, Key key, out vec3 origin, out vec3 direction) {
  vec2 at = (vec2(pixel) + random2(key, kDimPixel)) / vec2(size) * 2.0 - 1.0;
  vec3 target = frame.forward + at.x * frame.right - at.y * frame.up;
  if (frame.orthographic != 0.0) {
    origin = frame.eye + at.x * frame.right - at.y * frame.up;
    direction = normalize(frame.forward);
    return;
  }
  vec2 lens = frame.aperture_radius * disc(random2(key, kDimLens));
  vec3 shift = lens.x * normalize(frame.right) + lens.y * normalize(frame.up);
  origin = frame.eye + shift;
  direction = normalize(target - shift);
}

// Adds samples to the picture. Several dispatches give the same sum as one: the addends and their
// order are the same.
void finish_pixel(uvec2 pixel, vec3 sum) {
  ivec2 at = ivec2(pixel);
  imageStore(accumulation, at, vec4(sum, 1.0));
  vec3 mean = sum / float(frame.first_sample + frame.samples) * frame.exposure;
  imageStore(picture, at, vec4(sqrt(clamp(mean, 0.0, 1.0)), 1.0));
}
vec3 start_pixel(uvec2 pixel) {
  return frame.first_sample == 0u ? vec3(0.0) : imageLoad(accumulation, ivec2(pixel)).rgb;
}
