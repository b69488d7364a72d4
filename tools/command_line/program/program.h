#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <tuple>

namespace hqslam::tools {

/// What a program is called and does, for its help.
struct ProgramText {
  std::string name;  ///< "hqslam"
  std::string description;
};

/// Declares what every program of the project has: version, help, exit statuses.
void declare_program(CLI::App& app, const ProgramText& text);

/// Declares one subcommand for each element of `commands`, in this order, which is the help's.
/// Parsing fills the options of the subcommand that was chosen and sets `chosen` to what runs it.
/// Each option has one definition, in its command's file: it drives parsing, validation and --help.
template <typename... Options>
void declare_commands(CLI::App& app, std::tuple<Options...>& commands,
                      std::function<int()>& chosen) {
  const auto add = [&](auto& command) {
    declare(app, command);
    app.get_subcommands({}).back()->callback([&] { chosen = [&] { return run(command); }; });
  };
  std::apply([&](auto&... each) { (add(each), ...); }, commands);
}

/// Parses, runs the chosen subcommand and returns its ExitStatus. Never throws; wrong input gives
/// one line on stderr.
int exit_status_of(CLI::App& app, const std::function<int()>& chosen, int argc,
                   const char* const* argv);

/// A program of the project, from main() to its exit status. The program starts itself once more
/// with a short spin for OpenMP's waiting threads (see program.cpp).
template <typename Commands>
int run_program(const ProgramText& text, int argc, char** argv);

/// What happens before anything else in run_program: standard streams, thread limits, waiting.
void prepare_program(char** argv);
/// kFailure where standard output could not be written, else `status`.
int final_status(int status);

template <typename Commands>
int run_program(const ProgramText& text, int argc, char** argv) {
  prepare_program(argv);
  CLI::App app("", text.name);
  Commands commands;
  std::function<int()> chosen;
  declare_program(app, text);
  declare_commands(app, commands, chosen);
  return final_status(exit_status_of(app, chosen, argc, argv));
}

}  // namespace hqslam::tools
