// Payload of the recursive workload: each closest-hit call returns the light along its ray.
struct WhittedPayload {
  vec3 color;
  uint depth;  // rays above this one
  Key key;
};
