#pragma once

#include <functional>
#include <tuple>

#include "commands.h"
#include "laboratory/table/table_plan.h"
#include "simulate/simulate_command.h"

namespace hqslam::tools {

/// The options of every subcommand. Each has one definition, in its command's file: it drives
/// parsing, validation and --help.
struct CommandLine {
  std::tuple<RunOptions, LiveOptions, InfoOptions, DemoOptions, SimulateOptions, MapOptions,
             ViewOptions, EvaluateOptions, EvaluateMapOptions, CompareOptions, InspectOptions,
             BenchOptions, TableOptions, TrainOptions, CalibrateOptions, UpsampleOptions,
             WeightsOptions, SlamOptionsCommand>
      commands;                 ///< in the order of the help
  std::function<int()> chosen;  ///< runs the subcommand that was asked for, with its options
};

/// Declares the program: parsing fills `options`.
void declare_program(CLI::App& app, CommandLine& options);

/// Parses, runs the subcommand and returns its ExitStatus. Never throws; wrong input is one line on
/// stderr.
int run_program(int argc, const char* const* argv);

}  // namespace hqslam::tools
