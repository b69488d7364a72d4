#pragma once

#include "program/program.h"
#include "simulate/simulate_command.h"

namespace hqslam::tools {

// The subcommands, each in the file of its name, with its options.
void add_demo(CLI::App& app, Chosen& chosen);
void add_train(CLI::App& app, Chosen& chosen);
void add_compare(CLI::App& app, Chosen& chosen);
void add_table(CLI::App& app, Chosen& chosen);
void add_bench(CLI::App& app, Chosen& chosen);
void add_evaluate_map(CLI::App& app, Chosen& chosen);

inline Program laboratory() {
  return {"hqslam-lab",
          "hqslam's laboratory: simulated drives, training, and comparison of methods.",
          {add_demo, add_subcommand<SimulateOptions>, add_train, add_compare, add_table, add_bench,
           add_evaluate_map}};
}

}  // namespace hqslam::tools
