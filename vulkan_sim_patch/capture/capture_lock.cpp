#include "capture/capture_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace a2rt::layer {

CaptureLock::CaptureLock(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  taken_ = folder_ >= 0 && ::flock(folder_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

CaptureLock::~CaptureLock() {
  if (folder_ >= 0) {
    // Closing is not enough: a forked child that runs on has the same lock.
    if (!taken_) {
      ::flock(folder_, LOCK_UN);
    }
    ::close(folder_);
  }
}

}  // namespace a2rt::layer
