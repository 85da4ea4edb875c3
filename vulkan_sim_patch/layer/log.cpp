#include "layer/log.h"

#include <unistd.h>

#include <atomic>

namespace a2rt::layer {
namespace {
// The level is process-wide because a line may concern no device yet.
std::atomic<LogLevel>& level_in_force() {
  static std::atomic<LogLevel> level{LogLevel::kWarn};
  return level;
}
}  // namespace

void set_log_level(LogLevel level) { level_in_force() = level; }

void log(LogLevel level, const std::string& message) {
  if (level > level_in_force().load()) {
    return;
  }
  const std::string line = "a2rt-layer: " + message + "\n";
  // One write, so that lines of several threads do not mix; a closed stderr is not our problem.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace a2rt::layer
