#include "command_line.h"

#include <omp.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <string>
#include <tuple>

#include "hqslam/core/error.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

int report_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    return app.exit(error);  // --help and --version
  }
  const auto subcommands = app.get_subcommands();
  const std::string name = subcommands.empty() ? "" : subcommands.front()->get_name();
  if (name.empty() && !app.remaining().empty()) {
    to_stderr("hqslam: '{}' is no subcommand; hqslam --help lists them\n", app.remaining().front());
    return kWrongInput;
  }
  to_stderr("hqslam: {}; hqslam {}{}--help lists what is expected\n", error.what(), name,
            name.empty() ? "" : " ");
  return kWrongInput;
}

}  // namespace

void declare_program(CLI::App& app, CommandLine& options) {
  app.description("LiDAR SLAM on plain CPUs: from a recorded drive to a trajectory and a map.");
  app.set_version_flag("--version", "hqslam " HQSLAM_VERSION);
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.get_formatter()->column_width(34);
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done, 2 wrong input (one line on stderr says what and how to mend it),\n"
      "130 interrupted, 1 anything else.");
  const auto add = [&](auto& command) {
    declare(app, command);
    app.get_subcommands({}).back()->callback(
        [&] { options.chosen = [&] { return run(command); }; });
  };
  std::apply([&](auto&... commands) { (add(commands), ...); }, options.commands);
}

namespace {

/// OMP_NUM_THREADS may say anything; the stacks of too many threads do not fit.
void limit_threads() {
  constexpr int kMostThreads = 256;
  if (omp_get_max_threads() > kMostThreads) omp_set_num_threads(kMostThreads);
}

int exit_status_of(int argc, const char* const* argv) {
  CLI::App app("", "hqslam");
  CommandLine options;
  declare_program(app, options);
  try {
    app.parse(argc, argv);
    return options.chosen();
  } catch (const CLI::ParseError& error) {
    return report_parse_error(app, error);
  } catch (const Error& error) {
    to_stderr("hqslam: {}\n", error.what());
    return kWrongInput;
  } catch (const std::filesystem::filesystem_error& error) {
    to_stderr("hqslam: {}: {}; check the path\n", error.path1().string(), error.code().message());
    return kWrongInput;
  } catch (const std::exception& error) {
    to_stderr("hqslam: failed: {}\n", error.what());
    return kFailure;
  }
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  prepare_standard_streams();
  limit_threads();
  nn::add_compared_networks();
  const int status = exit_status_of(argc, argv);
  return all_printed() || status != kOk ? status : kFailure;
}

}  // namespace hqslam::tools
