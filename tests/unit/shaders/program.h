// Runs a2rt-render and reads what it wrote.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gltf_file.h"

namespace a2rt::test {

struct Outcome {
  int status = 0;
  std::string output;  // stdout and stderr
};
// `environment` is put in front, e.g. "LP_NUM_THREADS=1".
Outcome run_program(const std::string& arguments, const std::string& environment = "");

// Empty if a2rt-render can draw here, else the reason (no lavapipe, no ray-tracing pipelines).
std::string why_no_device();

// Linear RGB of a PFM file, row by row from the bottom.
std::vector<float> read_pfm(const std::filesystem::path& file);
std::string read_bytes(const std::filesystem::path& file);

}  // namespace a2rt::test
