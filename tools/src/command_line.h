#pragma once

#include <CLI/App.hpp>

#include "bench_command.h"
#include "compare_command.h"
#include "demo_command.h"
#include "evaluate_command.h"
#include "evaluate_map_command.h"
#include "info_command.h"
#include "inspect_command.h"
#include "live_command.h"
#include "map_command.h"
#include "run_command.h"
#include "simulate_command.h"
#include "table_command.h"
#include "train_command.h"
#include "upsample_command.h"
#include "weights_command.h"

namespace hqslam::tools {

/// The options of every subcommand. Each has one definition, in its command's file: it drives
/// parsing, validation and --help.
struct CommandLine {
  RunOptions run;
  LiveCommandOptions live;
  DemoOptions demo;
  SimulateOptions simulate;
  MapOptions map;
  EvaluateOptions evaluate;
  EvaluateMapOptions evaluate_map;
  BenchOptions bench;
  CompareOptions compare;
  InfoOptions info;
  InspectOptions inspect;
  TableOptions table;
  TrainOptions train;
  UpsampleOptions upsample;
  WeightsOptions weights;
};

/// Declares the program: parsing fills `options`.
void declare_program(CLI::App& app, CommandLine& options);

/// Parses, runs the subcommand and returns its ExitStatus. Never throws; wrong input is one line on
/// stderr.
int run_program(int argc, const char* const* argv);

}  // namespace hqslam::tools
