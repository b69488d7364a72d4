#include "command_line.h"

#include <omp.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <string>

#include "hqslam/core/error.h"
#include "terminal/exit_status.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

/// The subcommand that was asked for, "" before one was recognised.
std::string chosen_subcommand(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? "" : chosen.front()->get_name();
}

int report_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    return app.exit(error);  // --help and --version
  }
  const std::string name = chosen_subcommand(app);
  if (name.empty() && !app.remaining().empty()) {
    to_stderr("hqslam: '{}' is no subcommand; hqslam --help lists them\n", app.remaining().front());
    return kWrongInput;
  }
  to_stderr("hqslam: {}; hqslam {}{}--help lists what is expected\n", error.what(), name,
            name.empty() ? "" : " ");
  return kWrongInput;
}

/// subcommand: of the one called `name`, if that has any.
int run_subcommand(const std::string& name, const std::string& subcommand,
                   const CommandLine& options) {
  if (name == "run") {
    return run_command(options.run);
  }
  if (name == "demo") {
    return demo_command(options.demo);
  }
  if (name == "simulate") {
    return simulate_command(options.simulate);
  }
  if (name == "evaluate") {
    return evaluate_command(options.evaluate);
  }
  if (name == "live") {
    return live_command(options.live);
  }
  if (name == "map") {
    return map_command(options.map);
  }
  if (name == "evaluate-map") {
    return evaluate_map_command(options.evaluate_map);
  }
  if (name == "compare") {
    return compare_command(options.compare);
  }
  if (name == "info") {
    return info_command(options.info);
  }
  if (name == "inspect") {
    return inspect_command(options.inspect);
  }
  if (name == "slam-options") {
    return slam_options_command(options.slam_options);
  }
  if (name == "table") {
    return table_command(options.table);
  }
  if (name == "train") {
    return train_command(options.train);
  }
  if (name == "upsample") {
    return upsample_command(options.upsample);
  }
  if (name == "weights") {
    return weights_command(subcommand, options.weights);
  }
  return bench_command(options.bench);
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
  declare_run(app, options.run);
  declare_live(app, options.live);
  declare_info(app, options.info);
  declare_demo(app, options.demo);
  declare_simulate(app, options.simulate);
  declare_map(app, options.map);
  declare_evaluate(app, options.evaluate);
  declare_evaluate_map(app, options.evaluate_map);
  declare_compare(app, options.compare);
  declare_inspect(app, options.inspect);
  declare_bench(app, options.bench);
  declare_table(app, options.table);
  declare_train(app, options.train);
  declare_upsample(app, options.upsample);
  declare_weights(app, options.weights);
  declare_slam_options(app, options.slam_options);
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
    const std::string name = chosen_subcommand(app);
    return run_subcommand(name, chosen_subcommand(*app.get_subcommand(name)), options);
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
  const int status = exit_status_of(argc, argv);
  return all_printed() || status != kOk ? status : kFailure;
}

}  // namespace hqslam::tools
