#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "commands.h"

namespace hqslam::tools {

struct DemoOptions {
  std::string out = "hqslam-demo";
};
void declare(CLI::App& app, DemoOptions& options);
int run(const DemoOptions& options);

struct TrainOptions {
  std::string config;
  std::string out;
  std::string drives;  ///< empty: the folder "drives" in `out`
  int threads = 0;     ///< 0: what OpenMP chooses
};
void declare(CLI::App& app, TrainOptions& options);
int run(const TrainOptions& options);

struct CompareOptions : InputChoice {
  std::vector<std::string> weights;
  std::string poses;  ///< for networks with a memory; empty: they have none of other scans
  bool no_look_ahead = false;
  std::int64_t every = 1;
  std::string json;   ///< file to write; empty: none
  std::string curve;  ///< page to write about the last weights' confidence; empty: none
  float tolerance_m = nn::SuperResolverOptions{}.tolerance_m;  ///< of that confidence
  bool filters = false;
  bool layers = false;
  std::string protocol = "own";  ///< or "tulip"
  int threads = 0;               ///< 0: what OpenMP chooses
};
void declare(CLI::App& app, CompareOptions& options);
int run(const CompareOptions& options);

struct BenchOptions {
  InputChoice recording;  ///< its input empty: a simulated drive
  std::string drive = "block";
  std::int64_t scans = 200;
  std::vector<std::string> weights;  ///< empty: those that come with the program
  bool json = false;
  bool cpu = false;  ///< say only which instruction set is in use
};
void declare(CLI::App& app, BenchOptions& options);
int run(const BenchOptions& options);

struct EvaluateMapOptions {
  std::vector<std::string> maps;
  std::string drive;
};
void declare(CLI::App& app, EvaluateMapOptions& options);
int run(const EvaluateMapOptions& options);

struct TableOptions;
void declare(CLI::App& app, TableOptions& options);
int run(const TableOptions& options);

}  // namespace hqslam::tools
