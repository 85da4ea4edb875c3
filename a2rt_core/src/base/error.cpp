#include "a2rt/base/error.h"

namespace a2rt {

void fail_check(const char* condition, const std::string& message, std::source_location where) {
  throw InternalError(std::string(where.file_name()) + ":" + std::to_string(where.line()) + ": " +
                      message + " (violated: " + condition + ")");
}

}  // namespace a2rt
