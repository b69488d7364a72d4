#include "training_scans.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/sim/drive.h"
#include "progress.h"

namespace hqslam::tools {
namespace {

/// "$NAME/rest" with the environment variable's value.
std::string expanded(const std::string& path) {
  if (!path.starts_with("$")) return path;
  const std::size_t slash = std::min(path.find('/'), path.size());
  const std::string name = path.substr(1, slash - 1);
  const char* value = std::getenv(name.c_str());
  if (value == nullptr) {
    throw Error(fmt::format("{}: the environment variable {} is not set", path, name));
  }
  return value + path.substr(slash);
}

void add_stack(const std::string& path, const SensorModel& sensor, std::vector<RangeImage>& scans) {
  NpyStackReader reader(expanded(path));
  if (reader.rows() != sensor.rows() || reader.columns() != sensor.columns) {
    throw Error(fmt::format("{}: images of {} x {}, expected the {} x {} of {}", path,
                            reader.rows(), reader.columns(), sensor.rows(), sensor.columns,
                            sensor.name));
  }
  for (std::int64_t i = 0; i < reader.images(); ++i) {
    RangeImage image = reader.read(i);
    for (float& range_m : image.range_m) {
      if (!std::isfinite(range_m) || range_m < 0.0F) range_m = 0.0F;
    }
    scans.push_back(std::move(image));
  }
}

std::int64_t scans_of(const nn::SimulatedScans& drives) {
  return static_cast<std::int64_t>(drives.seeds.size()) *
         ((drives.scans + drives.every - 1) / drives.every);
}

}  // namespace

std::vector<RangeImage> load_scans(const nn::ScanSet& set, const SensorModel& sensor,
                                   const char* label, const InterruptGuard& interrupt) {
  std::vector<RangeImage> scans;
  for (const std::string& stack : set.stacks) add_stack(stack, sensor, scans);
  std::int64_t total = static_cast<std::int64_t>(scans.size());
  for (const nn::SimulatedScans& drives : set.simulated) total += scans_of(drives);
  Progress progress(label, total);
  for (const nn::SimulatedScans& drives : set.simulated) {
    for (const int seed : drives.seeds) {
      sim::DriveSpec spec = sim::drive_preset(drives.drive);
      spec.seed = static_cast<std::uint64_t>(seed);
      spec.scans = drives.scans;
      sim::DriveSimulator simulator(spec, sensor);
      while (auto scan = simulator.next()) {
        if (interrupt.stop_requested()) return scans;
        scans.push_back(std::move(scan->image));
        simulator.skip(drives.every - 1);
        progress.update(static_cast<std::int64_t>(scans.size()));
      }
    }
  }
  progress.finish();
  return scans;
}

}  // namespace hqslam::tools
