// The workload reader on damaged files, and its validation on damaged content: it refuses with
// UserError, or what it returns can be traced.
//
// Input: one byte, then records of six bytes: where (4) and what (2). Even first byte: bytes of a
// file are changed, and the file cut at the last place if the byte is 2 modulo 4; the reader's
// checksum has to notice. Odd: fields of a workload in memory are changed, which a checksum would
// not show, then validated and traced.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "a2rt/base/error.h"
#include "a2rt/config/section.h"
#include "a2rt/rt/functional.h"
#include "a2rt/workload/file.h"
#include "a2rt/workload/synthetic.h"
#include "a2rt/workload/validate.h"

namespace a2rt {
namespace {

namespace fs = std::filesystem;

Workload small_workload() {
  synthetic::Config config;
  config.primitives = 60;
  config.instances = 3;
  config.masked_share = 0.3;
  config.width = config.height = 4;
  return synthetic::make(config);
}

struct Change {
  std::uint32_t place = 0;
  std::uint16_t value = 0;
};

Change next_change(const std::uint8_t*& data, std::size_t& size) {
  Change change;
  std::memcpy(&change.place, data, 4);
  std::memcpy(&change.value, data + 4, 2);
  data += 6;
  size -= 6;
  return change;
}

class Files {
 public:
  Files() {
    const fs::path base = fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    folder_ = base / ("a2rt-fuzz-workload-" + std::to_string(getpid()));
    fs::create_directories(folder_);
    write_workload(small_workload(), folder_ / "good.h5");
    std::ifstream in(folder_ / "good.h5", std::ios::binary);
    good_.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  ~Files() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  const std::string& good() const { return good_; }
  fs::path write(const std::string& bytes) const {
    std::ofstream(folder_ / "bad.h5", std::ios::binary | std::ios::trunc) << bytes;
    return folder_ / "bad.h5";
  }

 private:
  fs::path folder_;
  std::string good_;
};

void damage_file(bool cut, const std::uint8_t* data, std::size_t size) {
  static const Files files;
  std::string bytes = files.good();
  std::size_t place = bytes.size();
  while (size >= 6) {
    const Change change = next_change(data, size);
    place = change.place % bytes.size();
    bytes[place] = static_cast<char>(change.value);
  }
  if (cut) {
    bytes.resize(place);
  }
  try {
    validate(read_workload(files.write(bytes)), "damaged file");
  } catch (const UserError&) {
  }
}

// A word of one of the workload's tables.
void damage_field(Workload& w, const Change& change) {
  const std::uint32_t row = change.place / 64;
  // Small values, and the extremes.
  const std::uint32_t value = change.value >= 0xff00 ? 0xffffff00U | change.value : change.value;
  const auto pick = [row](auto& table) -> auto& { return table[row % table.size()]; };
  switch (change.place % 16) {
    case 0:
      pick(w.rays).tlas = value;
      break;
    case 1:
      pick(w.rays).dispatch = value;
      break;
    case 2:
      pick(w.rays).parent = value;
      break;
    case 3:
      pick(w.tlas[0].instances).blas = value;
      break;
    case 4:
      pick(w.blas[0].geometries).first = value;
      break;
    case 5:
      pick(w.blas[0].geometries).count = value;
      break;
    case 6:
      pick(w.driver_hits).primitive = value;
      break;
    case 7:
      pick(w.driver_hits).instance = value;
      break;
    case 8:
      pick(w.candidate_first) = value;
      break;
    case 9:
      w.candidates.resize(value % 97);
      break;
    case 10:
      pick(w.dispatches).first_ray = value;
      break;
    case 11:
      pick(w.dispatches).ray_count = value;
      break;
    case 12:
      w.rays.resize(value % 97);
      break;
    case 13:
      std::memcpy(&pick(w.blas[0].triangles).v[row % 3].y, &change, 4);
      break;
    case 14:
      std::memcpy(&pick(w.tlas[0].instances).world_to_object.m[row % 3][row % 4], &change, 4);
      break;
    default:
      pick(w.rays).flags = value;
      break;
  }
}

void damage_fields(const std::uint8_t* data, std::size_t size) {
  Workload w = small_workload();
  while (size >= 6 && !w.rays.empty()) {
    damage_field(w, next_change(data, size));
  }
  try {
    validate(w, "damaged workload");
  } catch (const UserError&) {
    return;
  }
  const config::Section section = config::Section::from_text("", "fuzzer");
  for (const char* name : {"baseline", "a2rt", "aqb8"}) {
    const auto unit = unit_registry().create(name, section);
    try {
      unit->build(w);
    } catch (const UserError&) {
      // AQB8 cannot encode extents beyond FP32 and says so; the others take every workload.
      if (std::string_view(name) != "aqb8") {
        throw;
      }
      continue;
    }
    rt::run_functional(*unit, w);
  }
}

}  // namespace
}  // namespace a2rt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const std::uint8_t head = data[0];
  if ((head & 1U) == 0) {
    a2rt::damage_file((head & 2U) != 0, data + 1, size - 1);
  } else {
    a2rt::damage_fields(data + 1, size - 1);
  }
  return 0;
}
