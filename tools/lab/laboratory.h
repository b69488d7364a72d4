#pragma once

#include <tuple>

#include "bench/bench_command.h"
#include "compare/compare_command.h"
#include "demo/demo_command.h"
#include "evaluate_map/evaluate_map_command.h"
#include "program/program.h"
#include "simulate/simulate_command.h"
#include "table/table_command.h"
#include "train/train_command.h"

namespace hqslam::tools {

/// The subcommands of the program hqslam-lab.
using LaboratoryCommands = std::tuple<DemoOptions, SimulateOptions, TrainOptions, CompareOptions,
                                      TableOptions, BenchOptions, EvaluateMapOptions>;

inline ProgramText laboratory_text() {
  return {"hqslam-lab",
          "hqslam's laboratory: simulated drives, training, and comparison of methods."};
}

}  // namespace hqslam::tools
