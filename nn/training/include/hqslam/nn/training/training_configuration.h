#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/nn/architectures.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/training/trainer.h"

namespace hqslam::nn {

/// Whether all drives have the same sensor mount on a clear day, or each its own, which the
/// simulator draws from its seed.
enum class DriveConditions { kUsual, kVaried };

/// Simulated drives to take scans from: every `every`-th of `scans` scans, for each seed.
struct SimulatedScans {
  std::string drive;
  std::vector<int> seeds;
  std::int64_t scans = 0;
  std::int64_t every = 1;
  DriveConditions conditions = DriveConditions::kUsual;
  std::string sensor_errors = "typical";  ///< as `hqslam-lab simulate --sensor-errors` names them
  /// Whether networks with a memory recall what was measured after a scan, too (kLookAheadScans).
  bool look_ahead = false;
  /// Whether each drive has a sensor of its own, drawn from TrainingConfiguration::drawn_from by
  /// its seed.
  bool own_sensors = false;
};

/// An .npy file of range images, or the folder of a recording.
struct StackedScans {
  /// A leading $NAME is that environment variable's value.
  std::string path;
  std::optional<ScanSensor> sensor = {};  ///< nothing: the network's
};

/// Where scans come from.
struct ScanSet {
  std::vector<SimulatedScans> simulated;
  /// Each is listed as often as the recipe repeats it: a few real scans can be drawn as often as
  /// many simulated ones.
  std::vector<StackedScans> stacks;
};

/// What `hqslam-lab train --config` reads.
struct TrainingConfiguration {
  NetworkDescription network;
  TrainingPlan plan;
  ScanSet training;
  ScanSet validation;
  /// A sensor with many rows, of which drives or, without a memory, samples get some.
  std::optional<SensorModel> drawn_from;
  std::int64_t validate_every = 2000;  ///< steps; also when checkpoints are written
  std::string start_from;              ///< weights file to begin with; empty: random
};

/// Throws Error with `source`, field, expected, found; also if a drive's seed or a stack is in both
/// sets.
TrainingConfiguration training_configuration(
    const std::string& text, const std::string& source,
    const Architectures& architectures = hqs_architectures());

}  // namespace hqslam::nn
