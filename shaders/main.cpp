// a2rt-render: draws a glTF file or an embedded scene with Vulkan ray tracing.
#include <cstdio>
#include <exception>

#include "a2rt/base/error.h"
#include "render/job.h"
#include "render/options.h"

int main(int argc, char** argv) {
  try {
    int status = 0;
    const auto options = a2rt::render::parse_options(argc, argv, status);
    if (options) {
      a2rt::render::run(*options);
    }
    return status;
  } catch (const a2rt::UserError& e) {
    std::fprintf(stderr, "a2rt-render: %s\n", e.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "a2rt-render: not enough memory for this scene and picture size\n");
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "a2rt-render: internal error: %s\n", e.what());
    return 3;
  }
}
