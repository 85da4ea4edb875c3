// Whole units and their encoders on triangles and rays from raw bits: those that promise it miss
// nothing, the others answer something defined, and an encoder that refuses says so by UserError.
//
// Input: one byte, the number of rays (at most 8); then rays of eight floats (origin, direction,
// tmin, tmax), a transform of twelve floats if the byte's top bit is set, and triangles of nine
// floats. Missing bytes are zero.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "a2rt/hard/judge.h"

namespace a2rt::hard {
namespace {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool empty() const { return at_ >= size_; }
  std::uint8_t byte() { return at_ < size_ ? data_[at_++] : std::uint8_t{0}; }
  float number() {
    std::uint8_t raw[4];
    for (std::uint8_t& b : raw) {
      b = byte();
    }
    float x = 0;
    std::memcpy(&x, raw, sizeof x);
    return x;
  }
  Vec3 point() {
    Vec3 p;
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = number();
    }
    return p;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

void demand(bool holds, const UnitColumn& column, const char* claim) {
  if (!holds) {
    std::fprintf(stderr, "broken by %s: %s\n", column.key.c_str(), claim);
    std::abort();
  }
}

Instance read_instance(Bytes& bytes, bool transformed) {
  Instance instance;
  instance.blas = 0;
  if (transformed) {
    // A driver stores both maps; nothing here relies on one being the other's inverse but the
    // world box, which is made from world_to_object.
    for (auto& row : instance.world_to_object.m) {
      for (float& entry : row) {
        entry = bytes.number();
      }
    }
    instance.object_to_world = instance.world_to_object;
  }
  return instance;
}

Workload read_workload_of(Bytes& bytes) {
  Workload w;
  const std::uint8_t head = bytes.byte();
  for (std::uint8_t i = 0; i < (head & 7U) + 1; ++i) {
    Ray ray;
    ray.origin = bytes.point();
    ray.dir = bytes.point();
    ray.tmin = bytes.number();
    ray.tmax = bytes.number();
    w.rays.push_back(ray);
  }
  w.tlas.resize(1);
  w.tlas[0].instances.push_back(read_instance(bytes, (head & 0x80U) != 0));
  Blas blas;
  while (!bytes.empty() && blas.triangles.size() < 48) {
    const Vec3 a = bytes.point(), b = bytes.point(), c = bytes.point();
    blas.triangles.push_back({{a, b, c}});
  }
  blas.geometries.push_back({0, static_cast<std::uint32_t>(blas.triangles.size()), true});
  w.blas.push_back(std::move(blas));
  w.candidate_first.assign(w.rays.size() + 1, 0);
  return w;
}

void check_one(Bytes bytes) {
  const Workload workload = read_workload_of(bytes);
  const std::vector<Hit> truth = true_hits(workload);
  for (const UnitColumn& column : unit_columns()) {
    const Cell cell = judge(column, workload, truth);
    const bool promises = make_unit(column)->info().promise != Promise::kMayMiss;
    demand(!promises || cell.missed() == 0, column, "no box is missed");
    demand(!promises || cell.lost == 0, column, "no ray is lost");
    demand(!promises || cell.refusal.empty(), column, "it encodes every finite triangle");
  }
}

}  // namespace
}  // namespace a2rt::hard

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  a2rt::hard::check_one({data, size});
  return 0;
}
