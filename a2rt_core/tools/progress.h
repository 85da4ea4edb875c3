// A progress line on stderr: a bar on a terminal, "@progress SHARE WHAT" lines for a caller that
// sets A2RT_PROGRESS=1, and nothing otherwise.
#pragma once

#include <string>

namespace a2rt::tools {

class Progress {
 public:
  Progress();
  // Clears the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Share done, 0 to 1. Cheap to call often: it prints at most once per percent.
  void show(double share, const std::string& what);

 private:
  bool terminal_, lines_;
  int shown_ = -1;
  std::string what_;
};

}  // namespace a2rt::tools
