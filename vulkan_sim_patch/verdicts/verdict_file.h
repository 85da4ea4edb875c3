// Reads a verdict file (format: a2rt/capture/records.h) and hands out the tables of a dispatch.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "a2rt/capture/records.h"

namespace a2rt::layer {

struct LaunchVerdicts {
  std::uint32_t first;
  std::uint32_t count;
};

struct DispatchVerdicts {
  std::vector<LaunchVerdicts> index;  // one per launch id
  std::vector<capture::VerdictEntry> entries;
};

class VerdictFile {
 public:
  // Throws std::runtime_error naming the file, the place and the remedy if it is not a whole,
  // consistent verdict file.
  explicit VerdictFile(const std::string& path);

  // Null if the file says nothing about that dispatch.
  const DispatchVerdicts* find(std::uint32_t dispatch) const;
  std::size_t dispatches() const { return tables_.size(); }

 private:
  std::map<std::uint32_t, DispatchVerdicts> tables_;
};

}  // namespace a2rt::layer
