// The glTF reader on broken files: it gives a valid scene or throws UserError, nothing else.
//
// Input: the JSON text, a zero byte, then the binary chunk; this program wraps them into a .glb
// with right lengths, so that no effort is lost on the container. Without a zero byte the input is
// a .gltf as it stands. The mutator changes numbers and words of the JSON besides single bytes.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "a2rt/base/error.h"
#include "gltf/loader.h"

namespace a2rt {
namespace {

namespace fs = std::filesystem;

// A file in memory where there is /dev/shm, which is replaced for every input.
class Slot {
 public:
  Slot() {
    const fs::path base = fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    folder_ = base / ("a2rt-fuzz-gltf-" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  ~Slot() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  fs::path write(const std::string& bytes) const {
    const fs::path file = folder_ / "input.gltf";
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
    return file;
  }

 private:
  fs::path folder_;
};

void put(std::string& out, std::uint32_t word) {
  char raw[4];
  std::memcpy(raw, &word, 4);
  out.append(raw, 4);
}

// A .glb with the given chunks, padded as the format asks.
std::string wrap(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  put(out, 2);
  put(out, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  put(out, static_cast<std::uint32_t>(binary.size()));
  out += "BIN";
  out += '\0';
  return out + binary;
}

std::string file_of(const std::string& input) {
  const std::size_t zero = input.find('\0');
  return zero == std::string::npos ? input : wrap(input.substr(0, zero), input.substr(zero + 1));
}

void demand(bool holds, const char* claim) {
  if (!holds) {
    std::fprintf(stderr, "broken: %s\n", claim);
    std::abort();
  }
}

void check_one(const std::string& input) {
  static const Slot slot;
  try {
    const scene::Scene scene = gltf::load(slot.write(file_of(input)));
    demand(!scene.instances.empty(), "a scene that loads has something to draw");
    for (const scene::Mesh& mesh : scene.meshes) {
      for (const scene::Primitive& p : mesh.primitives) {
        for (const std::uint32_t i : p.indices) {
          demand(i < p.positions.size(), "every index names a vertex");
        }
        demand(p.material < scene.materials.size(), "every material exists");
      }
    }
  } catch (const UserError& error) {
    demand(std::strlen(error.what()) > 0, "an error says something");
  }
}

constexpr std::array<const char*, 16> kNumbers{
    "0",          "1",           "-1",   "2",     "3",     "255", "65535", "4294967295",
    "4294967296", "-2147483648", "1e38", "1e-45", "1e400", "0.5", "5126",  "5125"};

// Replaces a run of digits of the JSON by an interesting number; false if there is none.
bool mutate_number(std::string& input, std::minstd_rand& random) {
  const std::size_t end = std::min(input.find('\0'), input.size());
  std::size_t at = end == 0 ? 0 : random() % end;
  const auto digit = [&](std::size_t i) { return input[i] >= '0' && input[i] <= '9'; };
  while (at < end && !digit(at)) {
    ++at;
  }
  if (at >= end) {
    return false;
  }
  std::size_t last = at;
  while (last < end && (digit(last) || input[last] == '.')) {
    ++last;
  }
  input.replace(at, last - at, kNumbers[random() % kNumbers.size()]);
  return true;
}

// Exchanges two quoted words of the JSON.
bool swap_words(std::string& input, std::minstd_rand& random) {
  const std::size_t end = std::min(input.find('\0'), input.size());
  std::array<std::size_t, 2> first{}, size{};
  std::size_t from = end == 0 ? 0 : random() % end;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t open = input.find('"', from), close = input.find('"', open + 1);
    if (open >= end || close >= end) {
      return false;
    }
    first[i] = open + 1;
    size[i] = close - open - 1;
    from = close + 1;
  }
  const std::string a = input.substr(first[0], size[0]), b = input.substr(first[1], size[1]);
  input.replace(first[1], size[1], a);
  input.replace(first[0], size[0], b);
  return true;
}

}  // namespace
}  // namespace a2rt

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  std::minstd_rand random(seed);
  const auto choice = random() % 4;
  std::string input(reinterpret_cast<const char*>(data), size);
  const bool done = choice == 0   ? a2rt::mutate_number(input, random)
                    : choice == 1 ? a2rt::swap_words(input, random)
                                  : false;
  if (!done || input.size() > most) {
    return LLVMFuzzerMutate(data, size, most);
  }
  std::memcpy(data, input.data(), input.size());
  return input.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  a2rt::check_one({reinterpret_cast<const char*>(data), size});
  return 0;
}
