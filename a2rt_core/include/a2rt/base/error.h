// Errors that name the place, the reason and the remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace a2rt {

// An error the user can act on: bad input, a missing file, an unknown name. The message names what
// was wrong, where (file, line, record) and what to do. Tools print it and exit with status 2.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A broken promise inside the program. Always on, also in release builds.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

// What A2RT_CHECK calls; file and line are macros because clang before 16 has no source_location.
[[noreturn]] void fail_check(const char* condition, const std::string& message, const char* file,
                             int line);

}  // namespace a2rt

// Internal invariant; throws InternalError naming condition, message and place.
#define A2RT_CHECK(condition, message)                               \
  do {                                                               \
    if (!(condition)) [[unlikely]] {                                 \
      ::a2rt::fail_check(#condition, (message), __FILE__, __LINE__); \
    }                                                                \
  } while (false)
