#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/nn/super_resolver.h"
#include "recording/recording_choice.h"
#include "run/dense_map.h"
#include "run/occupancy_grid.h"
#include "run/slam_run.h"
#include "run/slam_settings.h"
#include "terminal/terminal.h"
#include "upsample/upsample_output.h"

namespace hqslam::tools {

// The subcommands that no other one uses: what a user may say to each. declare() adds it to the
// program; run() does it and returns an ExitStatus. Both may throw Error.

struct InfoOptions {
  std::string input;
  std::string sensor;  ///< empty: what the recording says
  std::string stream;  ///< empty: the only one with scans
  std::string write_sensor;
};
void declare(CLI::App& app, InfoOptions& options);
int run(const InfoOptions& options);

struct ViewOptions {
  std::vector<std::string> files;
  std::string sensor;     ///< of recordings; empty: what they say
  std::int64_t scan = 0;  ///< of recordings
  std::string out;
};
void declare(CLI::App& app, ViewOptions& options);
int run(const ViewOptions& options);

struct CalibrateOptions : InputChoice {
  int rows = 0;           ///< of the recording; 0: all
  double path_m = 150.0;  ///< that is looked at
  std::string out;
};
void declare(CLI::App& app, CalibrateOptions& options);
int run(const CalibrateOptions& options);

/// sensor empty: as upsampled_input says
struct UpsampleOptions : InputChoice, UpsamplingChoice {
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  UpsampledFormats formats;
};
void declare(CLI::App& app, UpsampleOptions& options);
int run(const UpsampleOptions& options);

struct InspectOptions : InputChoice {  ///< sensor empty: as for hqslam upsample
  std::string weights;
  bool slam = false;  ///< what SLAM makes of it, not the network; weights: upsampled by it first
  int rows = 0;       ///< of SLAM: of the recording, 0: all
  SlamSettings slam_settings;
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::int64_t scan = 0;
  std::vector<std::string> tensors;  ///< by name
  bool list = false;                 ///< say their names, write nothing
  bool reference = false;            ///< compare all of them with the reference
  std::string out;
};
void declare(CLI::App& app, InspectOptions& options);
int run(const InspectOptions& options);

struct WeightsOptions {
  std::string show;  ///< the weights file of `weights show`; empty: `weights pack`
  std::string arrays;
  std::string description;
  std::string out;
};
void declare(CLI::App& app, WeightsOptions& options);
int run(const WeightsOptions& options);

struct LiveOptions : UpsamplingChoice {
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
void declare(CLI::App& app, LiveOptions& options);
/// kOk where Ctrl-C ended it, which is how it is to end.
int run(const LiveOptions& options);

struct EvaluateOptions {
  std::string estimate;
  std::string reference;
  std::string alignment = "se3";
  std::string sensor;  ///< of two .npy stacks: adds the errors in 3-D
};
void declare(CLI::App& app, EvaluateOptions& options);
int run(const EvaluateOptions& options);

struct SlamOptionsCommand {
  bool json = false;
};
void declare(CLI::App& app, SlamOptionsCommand& options);
int run(const SlamOptionsCommand& options);

struct RunOptions : InputChoice, UpsamplingChoice {
  std::string out;
  std::string
      reference;    ///< empty: truth.tum in a folder written by `hqslam-lab simulate`, or none
  int threads = 0;  ///< 0: what OpenMP chooses
  SlamSettings slam;
  bool save_map = false;
  std::string map_file;       ///< to be located in; empty: a map of its own is made
  std::vector<double> start;  ///< x and y in metres, yaw in degrees; empty: anywhere
  bool dense_map = false;
  DenseMapChoice map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};

void declare(CLI::App& app, RunOptions& options);

/// Runs and writes the results, printing nothing but progress and warnings. Without a single scan
/// nothing is written. Throws Error, also if the first scan cannot be read.
SlamRun run_and_write(const RunOptions& options, const InterruptGuard& interrupt);

int run(const RunOptions& options);

struct MapOptions : InputChoice, UpsamplingChoice {
  std::string poses;
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  DenseMapChoice map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};

void declare(CLI::App& app, MapOptions& options);
int run(const MapOptions& options);

/// "dense map: 1234567 points, one per 0.1 m, of 300 scans, 12.3 s"
std::string dense_map_summary(const DenseMapRun& run);

}  // namespace hqslam::tools
