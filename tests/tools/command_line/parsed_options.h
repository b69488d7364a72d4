#pragma once

#include <CLI/CLI.hpp>

#include "program/program.h"
#include "testing.h"

namespace hqslam::tools {

/// Parses the arguments after a program's name, or after this. Throws CLI::ParseError.
inline void parse(CLI::App& app, const std::vector<std::string>& arguments) {
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
}
inline void parse(const Program& program, const std::vector<std::string>& arguments) {
  CLI::App app("", program.name);
  Chosen chosen;
  declare_program(app, program, chosen);
  parse(app, arguments);
}

/// What the arguments, of which the first is the command, make of its options.
template <typename Options>
Options parsed_options(const std::vector<std::string>& arguments) {
  CLI::App app;
  Options options;
  declare(app, options);
  parse(app, arguments);
  return options;
}

/// The help of a program, or of one of its commands.
inline std::string help_of(const Program& program, const std::string& command = "") {
  CLI::App app("", program.name);
  Chosen chosen;
  declare_program(app, program, chosen);
  return command.empty() ? app.help() : app.get_subcommand(command)->help();
}

}  // namespace hqslam::tools
