#include "simulate/simulate_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <numbers>

#include "files/result_folder.h"
#include "hqslam/core/error.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"
#include "hqslam/sim/write_drive.h"
#include "recording/drive_folder.h"
#include "simulate/seed.h"
#include "terminal/exit_status.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

/// Of --seed's text, empty if there is none: read as a number alone, -1 would become 2^64 - 1.
std::string seed_complaint(const std::string& text) {
  return seed_from(text) ? "" : fmt::format("{}: expected a whole number from 0 to 2^64 - 1", text);
}

sim::SensorMount mount_of(sim::SensorMount mount, const std::vector<double>& roll_pitch_deg) {
  constexpr double kDegree_rad = std::numbers::pi / 180.0;
  constexpr double kMostRoll_deg = 180.0;
  constexpr double kMostPitch_deg = 45.0;
  const double roll_deg = roll_pitch_deg[0];
  const double pitch_deg = roll_pitch_deg[1];
  if (!(std::abs(roll_deg) <= kMostRoll_deg && std::abs(pitch_deg) <= kMostPitch_deg)) {
    throw Error(fmt::format(
        "--mount {},{}: expected a roll from {} to {} and a pitch from {} to {} degrees; give two "
        "such angles",
        roll_deg, pitch_deg, -kMostRoll_deg, kMostRoll_deg, -kMostPitch_deg, kMostPitch_deg));
  }
  mount.mount_roll_rad = roll_deg * kDegree_rad;
  mount.mount_pitch_rad = pitch_deg * kDegree_rad;
  return mount;
}

sim::DriveSpec drive_of(const SimulateOptions& options) {
  sim::DriveSpec spec = sim::drive_preset(options.drive);
  spec.scans = options.scans.value_or(spec.scans);
  spec.seed = options.seed.value_or(spec.seed);
  spec.sensor_errors = sim::sensor_errors_named(options.sensor_errors);
  if (!options.mount.empty()) spec.mount = mount_of(spec.mount, options.mount);
  return spec;
}

}  // namespace

void declare_simulate(CLI::App& app, SimulateOptions& options) {
  CLI::App* command =
      app.add_subcommand("simulate", "Drive a LiDAR through a simulated city, with the truth");
  command
      ->add_option(
          "--drive", options.drive,
          "block: 200 scans of quiet streets; town: 4,000 with three loops; hills: 8,000, harder; "
          "meadow: 4,000 of open land; narrow: 3,000 between walls; yard: 2,000 of a low "
          "robot; handheld: 2,000 on foot; handheld-turning, handheld-sparse: a hand that turns "
          "fast, "
          "a scan every half second; car-park: 2,000, both ways round; "
          "indoors: 2,000 through rooms and up stairs")
      ->required()
      ->check(CLI::IsMember(sim::drive_preset_names()));
  command->add_option("--sensor", options.sensor, "Sensor (name or .json file, as for hqslam run)")
      ->required();
  command->add_option("--out", options.out, "Folder to write; made if it is not there")->required();
  command->add_option("--scans", options.scans, "Length (default: the drive's own)")
      ->check(CLI::Range(1, 1000000000));
  command
      ->add_option("--seed", options.seed, "Seed of city, traffic, driver and noise (default: 1)")
      ->check(seed_complaint);
  command
      ->add_option("--mount", options.mount,
                   "ROLL,PITCH: how the sensor is mounted, in degrees; positive roll raises the "
                   "left side, positive pitch lowers the front, 180,0 is upside down")
      ->delimiter(',')
      ->expected(2);
  command
      ->add_option(
          "--sensor-errors", options.sensor_errors,
          "How far the sensor is from its own table (default: none): typical is what makers "
          "promise, bad a badly kept one; the truth goes to sensor_errors.json")
      ->check(CLI::IsMember(sim::sensor_errors_names()));
  command->add_flag("--bin", options.bin, "Also write KITTI .bin files");
  command->add_flag("--pcd", options.pcd, "Also write .pcd files");
  command->add_flag("--imu", options.imu,
                    "Also write what an OS1's inertial sensor would measure: imu.csv, and its true "
                    "biases, imu_biases.csv");
  command->footer(
      "Writes into --out: scans.npy (N x rows x columns, float32 metres), sensor.json, "
      "drive.json,\n"
      "truth.tum and truth.kitti (true pose per scan), truth_columns.npy (true pose per column).\n"
      "hqslam run takes the folder as it is.");
}

int simulate_drive(const SimulateOptions& options, const InterruptGuard& interrupt,
                   const std::function<void()>& on_scan) {
  const sim::DriveSpec spec = drive_of(options);
  sim::DriveSimulator simulator(spec, load_sensor(options.sensor));
  make_result_folder(options.out);
  const FolderLock lock(options.out);
  clear_drive_folder(options.out, {options.sensor}, options.replaces_damaged);
  sim::DriveWriter writer(options.out, spec, simulator.sensor(),
                          {options.bin, options.pcd, options.imu});
  std::int64_t done = 0;
  while (!interrupt.stop_requested()) {
    const std::optional<sim::SimulatedScan> scan = simulator.next();
    if (!scan) {
      break;
    }
    writer.append(*scan);
    ++done;
    on_scan();
  }
  return done < simulator.scans() ? kInterrupted : kOk;
}

int simulate_drive(const SimulateOptions& options, const InterruptGuard& interrupt) {
  Progress progress(fmt::format("simulate {}", options.drive), drive_of(options).scans);
  std::int64_t done = 0;
  const int status = simulate_drive(options, interrupt, [&] { progress.update(++done); });
  progress.finish();
  return status;
}

int simulate_command(const SimulateOptions& options) {
  const InterruptGuard interrupt;
  const int status = simulate_drive(options, interrupt);
  if (status == kInterrupted) {
    to_stderr("hqslam: interrupted; the scans written up to there are valid\n");
  }
  to_stdout("results: {}\n", options.out);
  return status;
}

}  // namespace hqslam::tools
