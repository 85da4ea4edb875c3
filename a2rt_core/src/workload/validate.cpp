#include "a2rt/workload/validate.h"

#include "a2rt/base/error.h"

namespace a2rt {
namespace {

// One pass over a workload; each method checks one array.
class Validator {
 public:
  Validator(const Workload& workload, const std::string& name, const WorkloadParts& parts)
      : w_(workload), name_(name), parts_(parts) {}

  void run() const {
    for (std::size_t i = 0; i < w_.blas.size(); ++i) {
      blas(i);
    }
    for (std::size_t i = 0; i < w_.tlas.size(); ++i) {
      instances(i);
    }
    if (parts_.rays) {
      dispatches();
      rays();
      hits();
      candidates();
      segments();
    }
  }

 private:
  [[noreturn]] void fail(const std::string& object, std::size_t row,
                         const std::string& what) const {
    throw UserError(name_ + ": " + object + "[" + std::to_string(row) + "]: " + what);
  }
  // Fails unless index < count.
  void in_range(const char* object, std::size_t row, const char* field, std::uint64_t index,
                std::uint64_t count) const {
    if (index >= count) [[unlikely]] {
      fail(object, row,
           std::string(field) + " is " + std::to_string(index) + ", but there are only " +
               std::to_string(count));
    }
  }
  void same_count(const char* object, std::uint64_t found, std::uint64_t expected) const {
    if (found != expected) {
      throw UserError(name_ + ": " + object + " has " + std::to_string(found) + " rows, expected " +
                      std::to_string(expected));
    }
  }

  void blas(std::size_t index) const {
    const Blas& b = w_.blas[index];
    if (!b.triangles.empty() && !b.aabbs.empty()) {
      fail("blas", index, "has both triangles and boxes");
    }
    std::uint64_t next = 0;
    for (std::size_t g = 0; g < b.geometries.size(); ++g) {
      const Geometry& geometry = b.geometries[g];
      if (geometry.first != next) {
        fail("blas[" + std::to_string(index) + "].geometries", g,
             "starts at primitive " + std::to_string(geometry.first) + ", expected " +
                 std::to_string(next));
      }
      next += geometry.count;
    }
    if (parts_.primitives && next != b.primitive_count()) {
      fail("blas", index,
           "has " + std::to_string(b.primitive_count()) + " primitives, but its geometries name " +
               std::to_string(next));
    }
  }

  void instances(std::size_t index) const {
    const auto& all = w_.tlas[index].instances;
    const std::string object = "tlas[" + std::to_string(index) + "].instances";
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].blas != kNone) {
        in_range(object.c_str(), i, "blas", all[i].blas, w_.blas.size());
      }
    }
  }

  void dispatches() const {
    std::uint64_t ray = 0, segment = 0;
    for (std::size_t i = 0; i < w_.dispatches.size(); ++i) {
      const Dispatch& d = w_.dispatches[i];
      if (d.first_ray != ray || d.first_segment != segment) {
        fail("dispatches", i, "its rays or segments do not follow those of the one before");
      }
      if (d.ray_count > w_.rays.size() - ray || d.segment_count > w_.segments.size() - segment) {
        fail("dispatches", i, "names more rays or segments than there are");
      }
      ray += d.ray_count;
      segment += d.segment_count;
    }
    same_count("rays", w_.rays.size(), ray);
    same_count("segments", w_.segments.size(), segment);
  }

  static std::uint64_t launches(const Dispatch& d) {
    return std::uint64_t{d.width} * d.height * d.depth;
  }

  void rays() const {
    for (std::size_t d = 0; d < w_.dispatches.size(); ++d) {
      const Dispatch& dispatch = w_.dispatches[d];
      const std::uint64_t count = launches(dispatch);
      for (std::size_t i = dispatch.first_ray; i < dispatch.first_ray + dispatch.ray_count; ++i) {
        const Ray& ray = w_.rays[i];
        in_range("rays", i, "tlas", ray.tlas, w_.tlas.size());
        in_range("rays", i, "launch", ray.launch, count);
        in_range("rays", i, "ordinal", ray.ordinal, w_.rays.size());
        if (ray.dispatch != d) {
          fail("rays", i,
               "dispatch is " + std::to_string(ray.dispatch) + ", but it lies among the rays of " +
                   std::to_string(d));
        }
        if (ray.parent != kNone && ray.parent >= i) {
          fail("rays", i, "parent " + std::to_string(ray.parent) + " does not come before it");
        }
        if (i > dispatch.first_ray && w_.rays[i - 1].launch > ray.launch) {
          fail("rays", i, "is not in the order of launch ids");
        }
      }
    }
  }

  // Ids of a hit or candidate of ray `ray`.
  void ids(const char* object, std::size_t row, std::size_t ray, std::uint32_t instance,
           std::uint32_t geometry, std::uint32_t primitive) const {
    const Tlas& tlas = w_.tlas[w_.rays[ray].tlas];
    in_range(object, row, "instance", instance, tlas.instances.size());
    const std::uint32_t index = tlas.instances[instance].blas;
    if (index == kNone) {
      fail(object, row, "instance " + std::to_string(instance) + " is inactive");
    }
    const Blas& b = w_.blas[index];
    in_range(object, row, "geometry", geometry, b.geometries.size());
    in_range(object, row, "primitive", primitive, b.geometries[geometry].count);
  }

  void hits() const {
    same_count("driver_hits", w_.driver_hits.size(), w_.rays.size());
    for (std::size_t i = 0; i < w_.driver_hits.size(); ++i) {
      const Hit& hit = w_.driver_hits[i];
      in_range("driver_hits", i, "state", static_cast<std::uint32_t>(hit.state), 4);
      if (hit.state == HitState::kHit || hit.state == HitState::kHitInferred) {
        ids("driver_hits", i, i, hit.instance, hit.geometry, hit.primitive);
      }
    }
  }

  void candidates() const {
    same_count("candidate_first", w_.candidate_first.size(), w_.rays.size() + 1);
    if (w_.candidate_first.front() != 0) {
      fail("candidate_first", 0, "must be 0");
    }
    if (w_.candidate_first.back() != w_.candidates.size()) {
      fail("candidate_first", w_.rays.size(),
           "must be the number of candidates, " + std::to_string(w_.candidates.size()));
    }
    for (std::size_t i = 0; i < w_.rays.size(); ++i) {
      const std::uint64_t first = w_.candidate_first[i], last = w_.candidate_first[i + 1];
      if (last < first || last > w_.candidates.size()) {
        fail("candidate_first", i + 1, "decreases or exceeds the number of candidates");
      }
      for (std::uint64_t c = first; c < last; ++c) {
        ids("candidates", c, i, w_.candidates[c].instance, w_.candidates[c].geometry,
            w_.candidates[c].primitive);
      }
    }
  }

  void segments() const {
    for (const Dispatch& d : w_.dispatches) {
      const std::uint64_t count = launches(d);
      for (std::size_t i = d.first_segment; i < d.first_segment + d.segment_count; ++i) {
        const Segment& s = w_.segments[i];
        in_range("segments", i, "shader", s.shader, w_.shaders.size());
        in_range("segments", i, "launch", s.launch, count);
        if (s.ray != kNone && (s.ray < d.first_ray || s.ray - d.first_ray >= d.ray_count)) {
          fail("segments", i, "ray " + std::to_string(s.ray) + " is not of the same dispatch");
        }
      }
    }
  }

  const Workload& w_;
  const std::string& name_;
  const WorkloadParts& parts_;
};

}  // namespace

void validate(const Workload& workload, const std::string& name, const WorkloadParts& parts) {
  Validator(workload, name, parts).run();
}

}  // namespace a2rt
