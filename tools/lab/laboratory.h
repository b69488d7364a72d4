#pragma once

#include <tuple>

#include "lab_commands.h"
#include "program/program.h"
#include "simulate/simulate_command.h"
#include "table/table_plan.h"

namespace hqslam::tools {

/// The subcommands of the program hqslam-lab.
using LaboratoryCommands = std::tuple<DemoOptions, SimulateOptions, TrainOptions, CompareOptions,
                                      TableOptions, BenchOptions, EvaluateMapOptions>;

inline ProgramText laboratory_text() {
  return {"hqslam-lab",
          "hqslam's laboratory: simulated drives, training, and comparison of methods."};
}

}  // namespace hqslam::tools
