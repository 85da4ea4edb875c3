// a2rt-core: the engine behind scripts/a2rt. Users type `a2rt`; this is what it runs.
#include <cstdio>
#include <exception>
#include <map>

#include "a2rt/base/error.h"
#include "command.h"

namespace a2rt::tools {
namespace {

struct Command {
  std::string sentence, examples;
  Setup setup;
};

// Filled by the RegisterCommand objects before main starts.
std::map<std::string, Command>& commands() {
  static std::map<std::string, Command> all;
  return all;
}

int run(int argc, char** argv) {
  cli::Program program("A2RT simulator core", "a2rt-core");
  std::map<std::string, std::function<int()>> actions;
  for (const auto& [name, command] : commands()) {
    cli::Options options =
        program.add_subcommand(name, command.sentence, "Examples:\n" + command.examples);
    actions[name] = command.setup(options);
  }
  if (const std::optional<int> status = program.parse(argc, argv, 2)) {
    return *status;
  }
  return actions.at(program.subcommand())();
}

}  // namespace

RegisterCommand::RegisterCommand(const std::string& name, const std::string& sentence,
                                 const std::string& examples, Setup setup) {
  A2RT_CHECK(commands().emplace(name, Command{sentence, examples, std::move(setup)}).second,
             "two commands are named '" + name + "'");
}

}  // namespace a2rt::tools

// Exit status: 0 done, 1 the checked thing does not hold, 2 bad input or usage, 3 a bug.
int main(int argc, char** argv) {
  try {
    return a2rt::tools::run(argc, argv);
  } catch (const a2rt::InternalError& e) {
    std::fprintf(stderr, "a2rt-core: bug: %s\n", e.what());
    return 3;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "a2rt-core: error: %s\n", e.what());
    return 2;
  }
}
