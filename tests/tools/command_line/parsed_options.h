#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "program/program.h"

namespace hqslam::tools {

/// What the arguments after the program's name make of the options of one of its commands. Throws
/// CLI::ParseError.
template <typename Commands, typename Options>
Options parsed_options(const ProgramText& text, const std::vector<std::string>& arguments) {
  CLI::App app("", text.name);
  Commands commands;
  std::function<int()> chosen;
  declare_program(app, text);
  declare_commands(app, commands, chosen);
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  return std::get<Options>(commands);
}

/// The help of a program, or of one of its commands.
template <typename Commands>
std::string help_of(const ProgramText& text, const std::string& command = "") {
  CLI::App app("", text.name);
  Commands commands;
  std::function<int()> chosen;
  declare_program(app, text);
  declare_commands(app, commands, chosen);
  return command.empty() ? app.help() : app.get_subcommand(command)->help();
}

}  // namespace hqslam::tools
