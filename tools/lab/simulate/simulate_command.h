#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/sim/drive.h"
#include "hqslam/sim/write_drive.h"
#include "terminal/terminal.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

/// The seed in a text, a whole number from 0 to 2^64 - 1; nothing for any other text.
std::optional<std::uint64_t> seed_from(std::string_view text);

/// "1..10", "3,5" or "1..3,7": the seeds in the order given, at most 10,000. Throws Error for
/// anything else, and for a seed that is there twice.
std::vector<std::uint64_t> seeds_from(const std::string& list);

struct SimulateOptions {
  std::string drive;
  std::string sensor;
  std::string out;
  std::optional<std::int64_t> scans;  ///< default: the drive's own length
  std::optional<std::uint64_t> seed;
  std::vector<double> mount;  ///< roll and pitch in degrees; empty: level
  std::string sensor_errors = "none";
  bool bin = false;
  bool pcd = false;
  bool imu = false;
};

void declare(CLI::App& app, SimulateOptions& options);
/// Simulates and writes, printing nothing but progress. Returns kOk or kInterrupted. Throws Error.
int simulate_drive(const SimulateOptions& options, const InterruptGuard& interrupt);
/// Simulates and writes into the folder `out`, printing nothing and calling `on_scan` after each
/// scan. sensor: as in SimulateOptions. Returns kOk or kInterrupted. Throws Error.
int simulate_drive(const sim::DriveSpec& spec, const std::string& sensor, const std::string& out,
                   const InterruptGuard& interrupt, const std::function<void()>& on_scan,
                   sim::ExtraFormats extra = {});
/// Returns an ExitStatus. Throws Error.
int run(const SimulateOptions& options);

}  // namespace hqslam::tools
