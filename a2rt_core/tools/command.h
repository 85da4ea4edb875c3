// Subcommands of a2rt-core: one .cpp per command, which registers itself.
#pragma once

#include <functional>
#include <string>

#include "a2rt/cli/options.h"

namespace a2rt::tools {

// Adds a subcommand's options to `app` and returns what to run once they are parsed (exit status).
using Setup = std::function<std::function<int()>(cli::Options& app)>;

struct RegisterCommand {
  // `sentence` is the one-line help; `examples` are shown below the options.
  RegisterCommand(const std::string& name, const std::string& sentence, const std::string& examples,
                  Setup setup);
};

}  // namespace a2rt::tools
