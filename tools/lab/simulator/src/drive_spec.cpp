#include <algorithm>
#include <nlohmann/json.hpp>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/sim/drive.h"
#include "hqslam/sim/write_drive.h"
#include "random.h"

namespace hqslam::sim {

namespace {

/// A number of a drive's mount or conditions; part and name are drive.json's.
struct Number {
  const char* part;
  const char* name;
  double& value;
  double low;
  double high;
};

std::vector<Number> numbers_of(DriveSpec& spec) {
  constexpr double kUpsideDown_rad = 3.1416;
  constexpr double kSteepest_rad = 0.7854;
  auto& [height_m, roll_rad, pitch_rad] = spec.mount;
  auto& [noise_m, dropout_share, extinction_per_m, airborne_share] = spec.conditions;
  return {{"mount", "sensor_height_m", height_m, 0.1, 10.0},
          {"mount", "mount_roll_rad", roll_rad, -kUpsideDown_rad, kUpsideDown_rad},
          {"mount", "mount_pitch_rad", pitch_rad, -kSteepest_rad, kSteepest_rad},
          {"conditions", "extra_range_noise_m", noise_m, 0.0, 1.0},
          {"conditions", "dropout_share", dropout_share, 0.0, 0.999},
          {"conditions", "extinction_per_m", extinction_per_m, 0.0, 1.0},
          {"conditions", "airborne_share", airborne_share, 0.0, 1.0}};
}

/// Normally distributed, cut off at 5 degrees.
double drawn_tilt_rad(Random& random) {
  return kDegree_rad * std::clamp(1.5 * random.normal(), -5.0, 5.0);
}

}  // namespace

void validate(const DriveSpec& spec) {
  constexpr std::int64_t kMostScans = 1'000'000;
  static_cast<void>(drive_preset(spec.name));
  if (spec.scans < 1 || spec.scans > kMostScans) {
    throw Error("drive '{}': scans is {}, expected 1 to {}; give a number in between", spec.name,
                spec.scans, kMostScans);
  }
  DriveSpec copy = spec;
  for (const Number& number : numbers_of(copy)) {
    if (number.value >= number.low && number.value <= number.high) continue;
    throw Error("drive '{}': {} is {}, expected {} to {}; give a number in between", spec.name,
                number.name, number.value, number.low, number.high);
  }
}

DriveSpec with_varied_conditions(DriveSpec spec) {
  Random random(seed_of(spec.seed, DrivePart::kConditions));
  spec.mount.sensor_height_m = random.uniform(0.4, 2.2);
  spec.mount.mount_roll_rad = drawn_tilt_rad(random);
  spec.mount.mount_pitch_rad = drawn_tilt_rad(random);
  // Squares: most sensors are good and most days are clear.
  const double noise = random.uniform();
  spec.conditions.extra_range_noise_m = 0.02 * noise * noise;
  const double dropout = random.uniform();
  spec.conditions.dropout_share = 0.06 * dropout * dropout;
  const bool bad_weather = random.chance(0.25);
  const double density = random.uniform();
  const double drops = random.uniform();
  if (bad_weather) {
    spec.conditions.extinction_per_m = 0.002 + 0.028 * density * density;
    spec.conditions.airborne_share = 0.02 * density * drops;
  }
  return spec;
}

DriveSpec read_drive_json(const std::string& path) {
  constexpr std::size_t kMostBytes = 1U << 16U;
  JsonFields fields(whole_file(path, "a drive.json written by hqslam-lab simulate", kMostBytes),
                    path, "give a folder written by hqslam-lab simulate, by this version of it");
  DriveSpec spec;
  spec.name = fields.text("name");
  spec.seed = fields.unsigned_integer("seed");
  spec.scans = fields.integer("scans");
  for (const Number& number : numbers_of(spec)) {
    if (fields.has(number.part)) number.value = fields.object(number.part).number(number.name);
  }
  if (fields.has("sensor_errors")) {
    spec.sensor_errors = sensor_errors_named(fields.text("sensor_errors"));
  }
  validate(spec);
  if (const auto revision = fields.integer("revision"); revision != kDriveRevision) {
    throw Error("{}: of drives of revision {}, expected {}: its city is another; simulate it anew",
                path, revision, kDriveRevision);
  }
  return spec;
}

void write_drive_json(const std::string& path, DriveSpec spec, const SensorModel& sensor) {
  nlohmann::ordered_json json = {{"name", spec.name},
                                 {"seed", spec.seed},
                                 {"revision", kDriveRevision},
                                 {"scans", spec.scans},
                                 {"sensor", sensor.name}};
  if (spec.mount != SensorMount{}) json["mount"] = {};
  if (spec.conditions != SensingConditions{}) json["conditions"] = {};
  for (const Number& number : numbers_of(spec)) {
    if (json.contains(number.part)) json[number.part][number.name] = number.value;
  }
  if (spec.sensor_errors != SensorErrors::kNone) {
    json["sensor_errors"] = name_of(spec.sensor_errors);
  }
  replace_file(path, [&](const std::string& part) { write_whole_file(part, json.dump(2) + "\n"); });
}

}  // namespace hqslam::sim
