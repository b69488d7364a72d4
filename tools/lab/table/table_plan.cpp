#include "table/table_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "hqslam/core/error.h"
#include "simulate/simulate_command.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

bool is_preset(const std::string& drive) {
  return std::ranges::count(sim::drive_preset_names(), drive) > 0;
}

/// The name of a recording's file or folder; for KITTI, whose scans are in folders "velodyne", the
/// name of the drive.
std::string recording_name(const fs::path& path) {
  const std::string name = path.stem().string();
  return name == "velodyne" ? path.parent_path().filename().string() : name;
}

/// Drives of a sensor with errors have names and folders of their own.
TableDrive simulated_drive(const std::string& drive, std::optional<std::uint64_t> seed,
                           const TableOptions& options) {
  std::string name = seed ? fmt::format("{}-seed-{}", drive, *seed) : drive;
  sim::DriveSpec spec = sim::drive_preset(drive);
  spec.sensor_errors = sim::sensor_errors_named(options.sensor_errors);
  if (spec.sensor_errors != sim::SensorErrors::kNone) name += "-" + options.sensor_errors;
  spec.scans = options.scans.value_or(spec.scans);
  spec.seed = seed.value_or(spec.seed);
  return {name, {.input = (fs::path(options.out) / "drives" / name).string()}, spec};
}

TableDrive recorded_drive(const std::string& drive, const TableOptions& options) {
  if (!options.seeds.empty() || !fs::exists(drive)) {
    throw Error("--drives: expected one of {}{}, found '{}'; choose another",
                fmt::join(sim::drive_preset_names(), ", "),
                options.seeds.empty() ? ", or a file or folder" : ", which --seeds simulates",
                drive);
  }
  const fs::path path = fs::canonical(drive);
  InputChoice recording = options.reading;
  recording.input = path.string();
  recordings::refuse_idle_options(recording.input, open_options(recording));  // before all work
  return {recording_name(path), recording, std::nullopt};
}

/// Simulated drives from every seed, if there are any.
std::vector<TableDrive> drives_of(const TableOptions& options) {
  std::vector<TableDrive> drives;
  for (const std::string& drive : options.drives) {
    if (!is_preset(drive)) {
      drives.push_back(recorded_drive(drive, options));
    } else if (options.seeds.empty()) {
      drives.push_back(simulated_drive(drive, std::nullopt, options));
    } else {
      for (const std::uint64_t seed : seeds_from(options.seeds)) {
        drives.push_back(simulated_drive(drive, seed, options));
      }
    }
  }
  return drives;
}

std::vector<TableMethod> methods_of(const TableOptions& options) {
  std::vector<TableMethod> methods;
  if (options.methods.empty()) methods = table_methods();
  for (const std::string& name : options.methods) {
    methods.push_back(method_named(name, "--methods"));
  }
  for (const std::string& weights : options.weights) {
    methods.push_back(method_named(weights, "--weights"));
  }
  return methods;
}

template <typename Named>
void require_different_names(const std::vector<Named>& all, const char* option) {
  std::set<std::string> names;
  for (const Named& named : all) {
    if (!names.insert(named.name).second) {
      throw Error("{}: expected different names, found '{}' twice; leave one out", option,
                  named.name);
    }
  }
}

/// Throws Error for a name that is none of the methods.
std::size_t paired_with(const std::vector<TableMethod>& methods, const std::string& against) {
  const std::string& name = against.empty() ? "linear" : against;
  const auto found = std::ranges::find(methods, name, &TableMethod::name);
  if (found != methods.end()) return static_cast<std::size_t>(found - methods.begin());
  if (against.empty()) return 0;
  throw Error(
      "--against: expected one of the rows to compute, found '{}'; add it to --methods or name "
      "another",
      against);
}

}  // namespace

TablePlan plan_table(const TableOptions& options) {
  TablePlan plan;
  plan.drives = drives_of(options);
  plan.over_seeds = !options.seeds.empty();
  plan.methods = methods_of(options);
  require_different_names(plan.drives, "--drives");
  require_different_names(plan.methods, "--methods and --weights");
  plan.against = paired_with(plan.methods, options.against);
  plan.scans = options.scans;
  plan.out = options.out;
  return plan;
}

void require_fitting_drives(const TablePlan& plan) {
  bool is_simulated_tried = false;  // all simulated drives have one sensor
  for (const TableDrive& drive : plan.drives) {
    if (drive.simulated && is_simulated_tried) continue;
    is_simulated_tried = is_simulated_tried || drive.simulated;
    const std::string& input = drive.recording.input;
    const SensorModel sensor =
        drive.simulated
            ? load_sensor(kSimulatedSensor)
            : recordings::Recording::open(input, open_options(drive.recording)).sensor();
    if (sensor.rows() != kTableAllRows) {
      throw Error(
          "{}: expected a recording with {} rows, found sensor '{}' with {}; give another of "
          "--drives, or --sensor",
          input, kTableAllRows, sensor.name, sensor.rows());
    }
    for (const TableMethod& method : plan.methods) {
      pipeline::Upsampler(sensor, upsampling_of(method), drive.name);
    }
  }
}

}  // namespace hqslam::tools
