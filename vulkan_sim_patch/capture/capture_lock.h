// Keeps a capture's folder to one process at a time.
#pragma once

#include <string>

namespace a2rt::layer {

// An exclusive lock on the folder itself, so that nothing is left in it. The kernel drops it with
// the process. A folder that cannot be locked (a file system without locks, one that cannot be
// made) counts as free: what is wrong with it shows when the files are opened.
class CaptureLock {
 public:
  // Makes the folder if it is missing.
  explicit CaptureLock(const std::string& folder);
  ~CaptureLock();
  CaptureLock(const CaptureLock&) = delete;
  CaptureLock& operator=(const CaptureLock&) = delete;

  // Whether another process captures into the folder now.
  bool is_taken() const { return taken_; }

 private:
  int folder_ = -1;
  bool taken_ = false;
};

}  // namespace a2rt::layer
