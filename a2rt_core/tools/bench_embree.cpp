#include "bench_embree.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define A2RT_EMBREE4 1
#else
#include <embree3/rtcore.h>
#define A2RT_EMBREE4 0
#endif

#include <cmath>
#include <cstring>

#include "a2rt/base/error.h"

namespace a2rt::tools {

struct EmbreeScene::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<RTCScene> parts;
};

namespace {

RTCScene new_scene(RTCDevice device) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

void attach(RTCDevice device, RTCScene scene, const Blas& blas) {
  const std::size_t n = blas.triangles.size();
  if (n == 0) {
    return;
  }
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3), 3 * n);
  std::memcpy(vertices, blas.triangles.data(), n * sizeof(Triangle));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), n));
  for (std::uint32_t i = 0; i < 3 * n; ++i) {
    indices[i] = i;
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

bool is_identity(const Affine& map) { return map == Affine{}; }

bool is_finite(const Affine& map) {
  for (const auto& row : map.m) {
    for (const float v : row) {
      if (!std::isfinite(v)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

EmbreeScene::EmbreeScene(const Workload& workload) : handles_(new Handles) {
  handles_->device = rtcNewDevice("threads=1");
  if (handles_->device == nullptr) {
    delete handles_;
    throw UserError("Embree could not start");
  }
  for (const Blas& blas : workload.blas) {
    RTCScene part = new_scene(handles_->device);
    attach(handles_->device, part, blas);
    rtcCommitScene(part);
    handles_->parts.push_back(part);
  }
  const std::vector<Instance> none;
  const std::vector<Instance>& instances =
      workload.tlas.empty() ? none : workload.tlas[0].instances;
  if (instances.size() == 1 && instances[0].blas != kNone &&
      is_identity(instances[0].object_to_world)) {
    // Embree's best case for such a scene: no instance at all.
    handles_->scene = handles_->parts[instances[0].blas];
    rtcRetainScene(handles_->scene);
    return;
  }
  handles_->scene = new_scene(handles_->device);
  for (const Instance& instance : instances) {
    if (instance.blas == kNone || !is_finite(instance.object_to_world)) {
      continue;
    }
    RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, handles_->parts[instance.blas]);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                            &instance.object_to_world.m[0][0]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(handles_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(handles_->scene);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(handles_->scene);
  for (RTCScene part : handles_->parts) {
    rtcReleaseScene(part);
  }
  rtcReleaseDevice(handles_->device);
  delete handles_;
}

bool EmbreeScene::trace(const Ray& ray) const {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
  query.ray.dir_x = ray.dir.x, query.ray.dir_y = ray.dir.y, query.ray.dir_z = ray.dir.z;
  query.ray.tnear = ray.tmin;
  query.ray.tfar = ray.tmax;
  query.ray.mask = 0xffffffffU;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if A2RT_EMBREE4
  rtcIntersect1(handles_->scene, &query);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(handles_->scene, &context, &query);
#endif
  return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

}  // namespace a2rt::tools
