#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/nn/super_resolver.h"
#include "lift/upsample_output.h"
#include "recording/recording_choice.h"
#include "run/dense_map.h"
#include "run/occupancy_grid.h"
#include "run/slam_run.h"
#include "run/slam_settings.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

// The subcommands that no other one uses: what a user may say to each. declare_X() adds it to the
// program; X_command() does it and returns an ExitStatus. Both may throw Error.

struct InfoOptions {
  std::string input;
  std::string sensor;  ///< empty: what the recording says
  std::string stream;  ///< empty: the only one with scans
  std::string write_sensor;
};
void declare_info(CLI::App& app, InfoOptions& options);
int info_command(const InfoOptions& options);

struct ViewOptions {
  std::vector<std::string> files;
  std::string sensor;     ///< of recordings; empty: what they say
  std::int64_t scan = 0;  ///< of recordings
  std::string out;
};
void declare_view(CLI::App& app, ViewOptions& options);
int view_command(const ViewOptions& options);

struct CalibrateOptions : InputChoice {
  int rows = 0;           ///< of the recording; 0: all
  double path_m = 150.0;  ///< that is looked at
  std::string out;
};
void declare_calibrate(CLI::App& app, CalibrateOptions& options);
int calibrate_command(const CalibrateOptions& options);

/// sensor empty: as lifted_input says
struct UpsampleOptions : InputChoice, LiftingChoice {
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  UpsampledFormats formats;
};
void declare_upsample(CLI::App& app, UpsampleOptions& options);
int upsample_command(const UpsampleOptions& options);

struct InspectOptions : InputChoice {  ///< sensor empty: as for hqslam upsample
  std::string weights;
  bool slam = false;  ///< what SLAM makes of it, not the network; weights: lifted by it first
  int rows = 0;       ///< of SLAM: of the recording, 0: all
  SlamSettings slam_settings;
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::int64_t scan = 0;
  std::vector<std::string> tensors;  ///< by name
  bool list = false;                 ///< say their names, write nothing
  bool reference = false;            ///< compare all of them with the reference
  std::string out;
};
void declare_inspect(CLI::App& app, InspectOptions& options);
int inspect_command(const InspectOptions& options);

struct WeightsOptions {
  std::string show;  ///< the weights file of `weights show`; empty: `weights pack`
  std::string arrays;
  std::string description;
  std::string out;
};
void declare_weights(CLI::App& app, WeightsOptions& options);
int weights_command(const WeightsOptions& options);

struct LiveOptions : LiftingChoice {
  std::string sensor;
  std::uint16_t port = 0;  ///< 0: the sensor's usual one
  std::string kept_return = "strongest";
  std::string out;
  std::string record;  ///< a .pcap file; empty: none
  int threads = 0;     ///< 0: what OpenMP chooses
  SlamSettings slam;
  std::optional<std::uint16_t> view;  ///< port of the page; nothing: no page
  std::string view_address = "127.0.0.1";
};
void declare_live(CLI::App& app, LiveOptions& options);
/// kOk where Ctrl-C ended it, which is how it is to end.
int live_command(const LiveOptions& options);

struct EvaluateOptions {
  std::string estimate;
  std::string reference;
  std::string alignment = "se3";
  std::string sensor;  ///< of two .npy stacks: adds the errors in 3-D
};
void declare_evaluate(CLI::App& app, EvaluateOptions& options);
int evaluate_command(const EvaluateOptions& options);

struct EvaluateMapOptions {
  std::vector<std::string> maps;
  std::string drive;
};
void declare_evaluate_map(CLI::App& app, EvaluateMapOptions& options);
int evaluate_map_command(const EvaluateMapOptions& options);

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
void declare_compare(CLI::App& app, CompareOptions& options);
int compare_command(const CompareOptions& options);

struct TableOptions;
void declare_table(CLI::App& app, TableOptions& options);
int table_command(const TableOptions& options);

struct TrainOptions {
  std::string config;
  std::string out;
  std::string drives;  ///< empty: the folder "drives" in `out`
  int threads = 0;     ///< 0: what OpenMP chooses
};
void declare_train(CLI::App& app, TrainOptions& options);
int train_command(const TrainOptions& options);

struct BenchOptions {
  InputChoice recording;  ///< its input empty: a simulated drive
  std::string drive = "block";
  std::int64_t scans = 200;
  std::vector<std::string> weights;  ///< empty: those that come with the program
  bool json = false;
  bool cpu = false;  ///< say only which instruction set is in use
};
void declare_bench(CLI::App& app, BenchOptions& options);
int bench_command(const BenchOptions& options);

struct DemoOptions {
  std::string out = "hqslam-demo";
};
void declare_demo(CLI::App& app, DemoOptions& options);
int demo_command(const DemoOptions& options);

struct SlamOptionsCommand {
  bool json = false;
};
void declare_slam_options(CLI::App& app, SlamOptionsCommand& options);
int slam_options_command(const SlamOptionsCommand& options);

struct RunOptions : InputChoice, LiftingChoice {
  std::string out;
  std::string reference;  ///< empty: truth.tum in a folder written by `hqslam simulate`, or none
  int threads = 0;        ///< 0: what OpenMP chooses
  SlamSettings slam;
  bool save_map = false;
  std::string map_file;       ///< to be located in; empty: a map of its own is made
  bool extend = false;        ///< the map, instead of being located in it
  std::vector<double> start;  ///< x and y in metres, yaw in degrees; empty: anywhere
  bool dense_map = false;
  DenseMapChoice map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};

void declare_run(CLI::App& app, RunOptions& options);

/// Runs and writes the results, printing nothing but progress and warnings. Without a single scan
/// nothing is written. Throws Error, also if the first scan cannot be read.
SlamRun run_and_write(const RunOptions& options, const InterruptGuard& interrupt);

int run_command(const RunOptions& options);

struct MapOptions : InputChoice, LiftingChoice {
  std::string poses;
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  DenseMapChoice map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};

void declare_map(CLI::App& app, MapOptions& options);
int map_command(const MapOptions& options);

/// "dense map: 1234567 points, one per 0.1 m, of 300 scans, 12.3 s"
std::string dense_map_summary(const DenseMapRun& run);

}  // namespace hqslam::tools
