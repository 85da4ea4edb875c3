#include "a2rt/base/error.h"

namespace a2rt {

void fail_check(const char* condition, const std::string& message, const char* file, int line) {
  throw InternalError(std::string(file) + ":" + std::to_string(line) + ": " + message +
                      " (violated: " + condition + ")");
}

}  // namespace a2rt
