#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace a2rt::tools {
namespace {

bool asked_for_lines() {
  const char* value = std::getenv("A2RT_PROGRESS");
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1), lines_(asked_for_lines()) {}

Progress::~Progress() {
  if (terminal_ && !lines_ && shown_ >= 0) {
    std::fputs("\r\033[K", stderr);
  }
}

void Progress::show(double share, const std::string& what) {
  const int percent = static_cast<int>(std::clamp(share, 0.0, 1.0) * 100);
  if ((!terminal_ && !lines_) || (percent == shown_ && what == what_)) {
    return;
  }
  shown_ = percent;
  what_ = what;
  if (lines_) {
    std::fprintf(stderr, "@progress %.2f %s\n", percent / 100.0, what.c_str());
  } else {
    constexpr int kWidth = 30;
    const std::string bar(static_cast<std::size_t>(percent * kWidth / 100), '#');
    std::fprintf(stderr, "\r\033[K[%-*s] %3d %% %s", kWidth, bar.c_str(), percent, what.c_str());
  }
}

}  // namespace a2rt::tools
