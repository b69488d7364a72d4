#include "train/training_scans.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "files/content_hash.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/nn/training/drawn_beams.h"
#include "hqslam/recordings/recording.h"
#include "recording/reading.h"

namespace hqslam::tools {
namespace {

/// Of scans without a sensor of their own.
const SensorModel& usual_sensor(const nn::TrainingConfiguration& configuration) {
  const std::optional<SensorModel>& drawn_from = configuration.plan.drawn_from;
  return drawn_from ? *drawn_from : configuration.network.sensor;
}

/// "$NAME/rest" with the environment variable's value.
std::string expanded(const std::string& path) {
  if (!path.starts_with("$")) return path;
  const std::size_t slash = std::min(path.find('/'), path.size());
  const std::string name = path.substr(1, slash - 1);
  const char* value = std::getenv(name.c_str());
  if (value == nullptr) {
    throw Error("{}: the environment variable {} is not set", path, name);
  }
  return value + path.substr(slash);
}

/// The path of a stack in the store with the scans of a recording's folder. It is written once; its
/// name is a hash of the folder's path and files and of the sensor.
std::string stack_of_recording(const std::string& folder, const SensorModel& sensor,
                               const DriveStore& store) {
  const std::string about =
      std::filesystem::absolute(folder).string() + folder_hash(folder) + sensor_json(sensor);
  const std::filesystem::path path = store.path / fmt::format("recording_{}.npy", text_hash(about));
  if (std::filesystem::exists(path)) return path.string();
  make_result_folder(store.path);
  replace_file(path.string(), [&](const std::string& part) {
    auto source = recordings::Recording::open(folder, {.all_rows = sensor});
    NpyStackWriter writer(part, sensor.rows(), sensor.columns);
    LeftOut left_out;
    while (const auto scan = next_usable(source, left_out)) {
      writer.append(range_image(scan->cloud));
    }
    if (left_out.scans > 0) to_stderr("hqslam-lab: {}: {}\n", folder, left_out.text());
  });
  return path.string();
}

/// The drive of a seed and, where it is not the training's, its sensor.
std::pair<StoredDrive, std::optional<nn::ScanSensor>> drive_of(
    const nn::SimulatedScans& simulated, int seed, const nn::TrainingConfiguration& configuration) {
  const nn::NetworkDescription& network = configuration.network;
  sim::DriveSpec spec = sim::drive_preset(simulated.drive);
  spec.seed = static_cast<std::uint64_t>(seed);
  spec.scans = simulated.scans;
  spec.sensor_errors = sim::sensor_errors_named(simulated.sensor_errors);
  if (simulated.conditions == nn::DriveConditions::kVaried) {
    spec = sim::with_varied_conditions(spec);
  }
  std::optional<nn::ScanSensor> own;
  if (simulated.own_sensors) {
    const nn::DrawnBeams beams =
        nn::draw_beams(*configuration.drawn_from, spec.seed, !has_scan_memory(network));
    own = {beams.sensor, beams.measured_rows};
  }
  StoredDrive drive{spec, own ? own->sensor : usual_sensor(configuration), simulated.every};
  if (has_scan_memory(network)) {
    drive.recalled_rows = own ? own->measured_rows : network.measured_rows;
  }
  drive.look_ahead = simulated.look_ahead;
  return {drive, own};
}

/// Throws Error if none of five evenly spread images of a stack has a range that the sensor can
/// measure, as in a stack in millimetres, without images or without ranges.
void require_returns(const std::string& path, const SensorModel& sensor) {
  constexpr std::int64_t kTried = 5;
  NpyStackReader reader(path);
  const std::int64_t last = reader.images() - 1;
  for (std::int64_t k = 0; k < kTried && last >= 0; ++k) {
    const RangeImage image = reader.read(last * k / (kTried - 1));
    const bool any = std::ranges::any_of(image.range_m, [&](float r) {
      return r >= sensor.min_range_m && r > 0.0F && r <= sensor.max_range_m;
    });
    if (any) return;
  }
  throw Error(
      "{}: expected images with ranges from {} to {} m (sensor '{}'), found none; give ranges in "
      "metres",
      path, sensor.min_range_m, sensor.max_range_m, sensor.name);
}

}  // namespace

StoredScans::StoredScans(const std::vector<ScanStack>& stacks, const SensorModel& usual) {
  for (const ScanStack& stack : stacks) {
    const SensorModel& sensor = stack.sensor ? stack.sensor->sensor : usual;
    const NpyStackReader reader(stack.path);
    const bool fits = reader.rows() == sensor.rows() || reader.rows() == 3 * sensor.rows();
    if (!fits || reader.columns() != sensor.columns) {
      throw Error("{}: images of {} x {}, expected the {} x {} of {}", stack.path, reader.rows(),
                  reader.columns(), sensor.rows(), sensor.columns, sensor.name);
    }
    require_returns(stack.path, sensor);
    const std::int64_t begin = size();
    files_.push_back({stack, sensor.rows(), sensor.columns, begin, begin + reader.images()});
  }
}

nn::TrainingScan StoredScans::read(std::int64_t i) const {
  if (i < 0 || i >= size()) {
    throw Error("training: scan {}, expected 0 to {}", i, size() - 1);
  }
  const File& file = *std::ranges::upper_bound(files_, i, {}, &File::end);
  RangeImage image = NpyStackReader(file.stack.path).read(i - file.begin);
  const bool recalls = image.rows == 3 * file.rows;
  if ((image.rows != file.rows && !recalls) || image.columns != file.columns) {
    throw Error(
        "{}: expected the images of the beginning, found others: it has changed; start again",
        file.stack.path);
  }
  for (float& range_m : image.range_m) {
    if (!std::isfinite(range_m) || range_m < 0.0F) range_m = 0.0F;
  }
  if (!recalls) return {std::move(image), {}, file.stack.sensor};
  const auto part = [&](int k) {
    RangeImage result(file.rows, file.columns);
    std::copy_n(image.range_m.begin() + k * std::ssize(result.range_m), result.range_m.size(),
                result.range_m.begin());
    return result;
  };
  return {part(0), {part(1), part(2).range_m}, file.stack.sensor};
}

std::unique_ptr<const StoredScans> stored_scans(const nn::ScanSet& set,
                                                const nn::TrainingConfiguration& configuration,
                                                const DriveStore& store, const char* label,
                                                const InterruptGuard& interrupt) {
  const SensorModel& usual = usual_sensor(configuration);
  std::vector<ScanStack> stacks;
  for (const nn::StackedScans& stack : set.stacks) {
    std::string path = expanded(stack.path);
    if (std::filesystem::is_directory(path)) {
      path = stack_of_recording(path, stack.sensor ? stack.sensor->sensor : usual, store);
    }
    stacks.push_back({path, stack.sensor});
  }
  // Errors in a stack are reported before hours of simulation.
  static_cast<void>(StoredScans(stacks, usual));
  std::vector<StoredDrive> drives;
  for (const nn::SimulatedScans& simulated : set.simulated) {
    for (const int seed : simulated.seeds) {
      auto [drive, own] = drive_of(simulated, seed, configuration);
      stacks.push_back({path_in_store(store.path, drive), std::move(own)});
      drives.push_back(std::move(drive));
    }
  }
  if (!store_drives(store, drives, label, interrupt)) return nullptr;
  return std::make_unique<const StoredScans>(stacks, usual);
}

}  // namespace hqslam::tools
