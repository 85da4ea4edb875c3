#pragma once

#include <vector>

#include "a2rt/workload/synthetic.h"

namespace a2rt::synthetic {

std::vector<Triangle> make_triangles(const Config& config, Random& random);
// Boxes around spheres; sphere i has centre and radius of box i.
std::vector<Box> make_boxes(const Config& config, Random& random);
// Identity first; then turned, scaled, every third mirrored, every fifth sheared.
std::vector<Instance> make_instances(const Config& config, Random& random);

Vec3 normalized(const Vec3& v);
Vec3 cross(const Vec3& a, const Vec3& b);
float dot(const Vec3& a, const Vec3& b);
Vec3 mix(const Vec3& a, const Vec3& b, float s);  // a + s * b

}  // namespace a2rt::synthetic
