#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hqslam::tools {

/// Runs the subcommand that was chosen, and returns its ExitStatus.
using Chosen = std::function<int()>;
using AddSubcommand = void (*)(CLI::App& app, Chosen& chosen);

struct Program {
  std::string name;         ///< "hqslam"
  std::string description;  ///< for its help
  std::vector<AddSubcommand> subcommands;
};

/// Declares what every program of the project has (version, help, exit statuses) and the
/// subcommands in their order, which is the help's. Parsing sets `chosen`.
void declare_program(CLI::App& app, const Program& program, Chosen& chosen);

/// A program of the project, from main() to its exit status. Never throws; wrong input gives one
/// line on stderr. The program starts itself once more with a short spin for OpenMP's waiting
/// threads (see program.cpp).
int run_program(const Program& program, int argc, char** argv);

/// `call` is called when the subcommand that was declared last is the one that was chosen.
void when_chosen(CLI::App& app, std::function<void()> call);

/// An AddSubcommand: declare(app, options) declares the subcommand, run(options) runs it. Each
/// option has one definition there: it drives parsing, validation and --help.
template <typename Options>
void add_subcommand(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<Options>();
  declare(app, *options);
  when_chosen(app, [options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace hqslam::tools
