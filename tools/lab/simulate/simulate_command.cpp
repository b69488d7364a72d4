#include "simulate/simulate_command.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <set>

#include "files/result_files.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/sensor_model.h"
#include "recording/recording_choice.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"

namespace hqslam::tools {
namespace {

constexpr std::size_t kMostSeeds = 10000;

[[noreturn]] void fail(const std::string& list) {
  throw Error(
      "--seeds: expected different whole numbers such as 1..10 or 3,5,8, at most {} of them, found "
      "'{}'",
      kMostSeeds, list);
}

std::uint64_t seed_of(std::string_view text, const std::string& list) {
  const std::optional<std::uint64_t> seed = seed_from(text);
  if (!seed) fail(list);
  return *seed;
}

/// The complaint about a text of --seed, empty for a valid one. (As a plain unsigned option, -1
/// would become 2^64 - 1.)
std::string seed_complaint(const std::string& text) {
  return seed_from(text) ? "" : fmt::format("{}: expected a whole number from 0 to 2^64 - 1", text);
}

sim::SensorMount mount_of(sim::SensorMount mount, const std::vector<double>& roll_pitch_deg) {
  constexpr double kMostRoll_deg = 180.0;
  constexpr double kMostPitch_deg = 45.0;
  const double roll_deg = roll_pitch_deg[0];
  const double pitch_deg = roll_pitch_deg[1];
  if (!(std::abs(roll_deg) <= kMostRoll_deg && std::abs(pitch_deg) <= kMostPitch_deg)) {
    throw Error(
        "--mount {},{}: expected a roll from {} to {} and a pitch from {} to {} degrees; give two "
        "such angles",
        roll_deg, pitch_deg, -kMostRoll_deg, kMostRoll_deg, -kMostPitch_deg, kMostPitch_deg);
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

std::optional<std::uint64_t> seed_from(std::string_view text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return seed;
}

std::vector<std::uint64_t> seeds_from(const std::string& list) {
  std::vector<std::uint64_t> seeds;
  std::set<std::uint64_t> listed;
  std::string_view rest = list;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    more = comma != std::string_view::npos;
    const std::string_view part = rest.substr(0, comma);
    rest.remove_prefix(more ? comma + 1 : rest.size());
    const std::size_t dots = part.find("..");
    const std::uint64_t first = seed_of(part.substr(0, dots), list);
    const std::uint64_t last =
        dots == std::string_view::npos ? first : seed_of(part.substr(dots + 2), list);
    if (last < first || last - first >= kMostSeeds - seeds.size()) fail(list);
    for (std::uint64_t i = 0; i <= last - first; ++i) {
      if (!listed.insert(first + i).second) fail(list);
      seeds.push_back(first + i);
    }
  }
  return seeds;
}

void declare(CLI::App& app, SimulateOptions& options) {
  Command command = add_command(
      app, "simulate", "Simulate the drive of a LiDAR through a city, with ground truth",
      "Writes into --out: scans.npy (N x rows x columns, float32 metres), intensity.npy (bytes),\n"
      "sensor.json, drive.json, truth.tum and truth.kitti (true pose per scan), truth_columns.npy\n"
      "(true pose per column).\n"
      "hqslam run takes the folder as it is.");
  command
      .option(
          "--drive", &options.drive,
          "Kind of city and motion. block: 200 scans of quiet streets; town: 4,000 scans with "
          "three loops; hills: 8,000 scans, steep and fast; town-busy, hills-busy: town and hills "
          "with four times the traffic; meadow: 4,000 scans of open land; narrow: 3,000 scans "
          "between walls; handheld: 2,000 scans on foot; handheld-turning: on foot, turned fast; "
          "handheld-sparse: on foot, a scan every half second; car-park: 2,000 scans, one loop in "
          "both directions; indoors: 2,000 scans through rooms and stairwells",
          {.required = true, .one_of = sim::drive_preset_names()})
      .option("--sensor", &options.sensor, "Sensor (name or .json file, as for hqslam run)",
              {.required = true})
      .option("--out", &options.out, "Folder for the drive, made if it does not exist",
              {.required = true})
      .option("--scans", &options.scans, "Number of scans (default: that of the drive)",
              {.within = kAnyCount})
      .option("--seed", &options.seed, "Seed of city, traffic, driver and noise (default: 1)",
              {.complaint = seed_complaint})
      .option("--mount", &options.mount,
              "ROLL,PITCH of the sensor's mounting, degrees; positive roll raises the left side, "
              "positive pitch lowers the front, 180,0 is upside down",
              {.delimiter = ',', .values = 2})
      .option(
          "--sensor-errors", &options.sensor_errors,
          "Errors of the sensor against its beam table (default: none): typical, as "
          "manufacturers specify, or bad, as of a poorly calibrated sensor; the true errors are "
          "written to sensor_errors.json",
          {.one_of = sim::sensor_errors_names()})
      .option("--bin", &options.bin, "Also write KITTI .bin files")
      .option("--pcd", &options.pcd, "Also write .pcd files")
      .option("--imu", &options.imu, "Also write the samples of an OS1's inertial sensor, imu.csv");
}

int simulate_drive(const sim::DriveSpec& spec, const std::string& sensor, const std::string& out,
                   const InterruptGuard& interrupt, const std::function<void()>& on_scan,
                   sim::ExtraFormats extra) {
  sim::DriveSimulator simulator(spec, load_sensor(sensor));
  make_result_folder(out);
  const FolderLock lock(out);
  clear_drive_folder(out, {sensor});
  sim::DriveWriter writer(out, spec, simulator.sensor(), extra);
  std::int64_t done = 0;
  while (!interrupt.stop_requested()) {
    const std::optional<sim::SimulatedScan> scan = simulator.next();
    if (!scan) break;
    writer.append(*scan);
    ++done;
    on_scan();
  }
  return done < simulator.scans() ? kInterrupted : kOk;
}

int simulate_drive(const SimulateOptions& options, const InterruptGuard& interrupt) {
  const sim::DriveSpec spec = drive_of(options);
  Progress progress(fmt::format("simulate {}", options.drive), spec.scans);
  const int status =
      simulate_drive(spec, options.sensor, options.out, interrupt, [&] { progress.advance(); },
                     {options.bin, options.pcd, options.imu});
  progress.finish();
  return status;
}

int run(const SimulateOptions& options) {
  const InterruptGuard interrupt;
  const int status = simulate_drive(options, interrupt);
  if (status == kInterrupted) {
    to_stderr("hqslam-lab: interrupted; the scans that were written are valid\n");
  }
  to_stdout("results: {}\n", options.out);
  return status;
}

}  // namespace hqslam::tools
