#include "a2rt/cli/options.h"

#include <CLI/CLI.hpp>

namespace a2rt::cli {
namespace {

template <class T>
Option add_to(CLI::App* app, const std::string& names, T& target, const std::string& sentence) {
  return Option(app->add_option(names, target, sentence));
}

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::check(const Check& check) {
  switch (check.kind) {
    case Check::Kind::kRange:
      option_->check(CLI::Range(check.least, check.most));
      break;
    case Check::Kind::kPositive:
      option_->check(CLI::PositiveNumber);
      break;
    case Check::Kind::kExistingFile:
      option_->check(CLI::ExistingFile);
      break;
    case Check::Kind::kOneOf:
      option_->check(CLI::IsMember(check.names));
      break;
  }
  return *this;
}

Option& Option::delimiter(char c) {
  option_->delimiter(c);
  return *this;
}

Option& Option::one_value_each() {
  option_->allow_extra_args(false);
  return *this;
}

Option Options::add(const std::string& names, std::string& target, const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, int& target, const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::uint32_t& target, const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::uint64_t& target, const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, float& target, const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, double& target, const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::vector<std::string>& target,
                    const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::vector<int>& target,
                    const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::vector<std::uint32_t>& target,
                    const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::optional<double>& target,
                    const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::optional<std::uint32_t>& target,
                    const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::add(const std::string& names, std::filesystem::path& target,
                    const std::string& sentence) {
  return add_to(app_, names, target, sentence);
}

Option Options::flag(const std::string& names, bool& target, const std::string& sentence) {
  return Option(app_->add_flag(names, target, sentence));
}

struct Program::Body {
  Body(const std::string& sentence, const std::string& name) : app(sentence, name) {}
  CLI::App app;
};

Program::Program(const std::string& sentence, const std::string& name)
    : body_(std::make_unique<Body>(sentence, name)) {}

Program::~Program() = default;

Options Program::options() { return Options(&body_->app); }

void Program::footer(const std::string& text) { body_->app.footer(text); }

Options Program::add_subcommand(const std::string& name, const std::string& sentence,
                                const std::string& footer) {
  body_->app.require_subcommand(1);
  CLI::App* command = body_->app.add_subcommand(name, sentence);
  command->footer(footer);
  return Options(command);
}

std::optional<int> Program::parse(int argc, char** argv, int usage_status) {
  try {
    body_->app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return body_->app.exit(e) == 0 ? 0 : usage_status;
  }
  return std::nullopt;
}

std::string Program::subcommand() const {
  const std::vector<CLI::App*> named = body_->app.get_subcommands();
  return named.empty() ? std::string() : named.front()->get_name();
}

}  // namespace a2rt::cli
