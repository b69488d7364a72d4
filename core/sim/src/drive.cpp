#include "hqslam/sim/drive.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"
#include "lidar.h"
#include "path_plan.h"
#include "ray_scene.h"
#include "scenario.h"

namespace hqslam::sim {

std::unique_ptr<Scenario> make_scenario(const DriveSpec& spec, double duration_s) {
  return has_streets(spec.name) ? make_street_scenario(spec, duration_s)
                                : make_indoor_scenario(spec, duration_s);
}

void validate(const DriveSpec& spec) {
  constexpr std::int64_t kMostScans = 1'000'000;
  static_cast<void>(drive_preset(spec.name));
  if (spec.scans < 1 || spec.scans > kMostScans) {
    throw Error(fmt::format("drive '{}': scans is {}, expected 1 to {}", spec.name, spec.scans,
                            kMostScans));
  }
  const auto check = [&](const char* field, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw Error(
        fmt::format("drive '{}': {} is {}, expected {} to {}", spec.name, field, value, low, high));
  };
  constexpr double kSteepest_rad = 0.7854;
  check("sensor_height_m", spec.mount.sensor_height_m, 0.1, 10.0);
  check("mount_roll_rad", spec.mount.mount_roll_rad, -kSteepest_rad, kSteepest_rad);
  check("mount_pitch_rad", spec.mount.mount_pitch_rad, -kSteepest_rad, kSteepest_rad);
  check("extra_range_noise_m", spec.conditions.extra_range_noise_m, 0.0, 1.0);
  check("dropout_share", spec.conditions.dropout_share, 0.0, 0.999);
  check("extinction_per_m", spec.conditions.extinction_per_m, 0.0, 1.0);
  check("airborne_share", spec.conditions.airborne_share, 0.0, 1.0);
}

struct DriveSimulator::Implementation {
  Implementation(const DriveSpec& spec_, const SensorModel& sensor_)
      : spec((validate(spec_), spec_)),
        sensor((validate(sensor_), sensor_)),
        scenario(make_scenario(spec, static_cast<double>(spec.scans) * sensor.scan_period_s)),
        scene(scenario->scenery()),
        lidar(sensor, spec.conditions, seed_of_part(spec.seed, DrivePart::kNoise)),
        T_map_world(scenario->T_world_sensor(0.5 * sensor.scan_period_s).inverse()) {}

  DriveSpec spec;
  SensorModel sensor;
  std::unique_ptr<Scenario> scenario;
  RayScene scene;
  Lidar lidar;
  Pose T_map_world;
  std::int64_t next_scan = 0;
};

DriveSimulator::DriveSimulator(const DriveSpec& spec, const SensorModel& sensor)
    : implementation_(std::make_unique<Implementation>(spec, sensor)) {}
DriveSimulator::~DriveSimulator() = default;
DriveSimulator::DriveSimulator(DriveSimulator&&) noexcept = default;
DriveSimulator& DriveSimulator::operator=(DriveSimulator&&) noexcept = default;

const SensorModel& DriveSimulator::sensor() const { return implementation_->sensor; }
std::int64_t DriveSimulator::scans() const { return implementation_->spec.scans; }

void DriveSimulator::skip(std::int64_t scans) { implementation_->next_scan += scans; }

std::optional<SimulatedScan> DriveSimulator::next() {
  Implementation& self = *implementation_;
  if (self.next_scan >= self.spec.scans) return std::nullopt;
  const double period_s = self.sensor.scan_period_s;
  const double begin_s = static_cast<double>(self.next_scan) * period_s;
  std::vector<Pose> T_world_sensor;
  for (int column = 0; column < self.sensor.columns; ++column) {
    T_world_sensor.push_back(
        self.scenario->T_world_sensor(begin_s + period_s * (column + 0.5) / self.sensor.columns));
  }
  SimulatedScan scan;
  scan.stamp_s = begin_s + 0.5 * period_s;
  const Pose T_world_middle = self.scenario->T_world_sensor(scan.stamp_s);
  self.scene.place_actors(
      self.scenario->actors(begin_s, begin_s + period_s, T_world_middle.translation().head<2>()));
  scan.image = self.lidar.measure(self.scene, T_world_sensor, self.next_scan);
  scan.T_map_sensor = self.T_map_world * T_world_middle;
  for (const Pose& pose : T_world_sensor) {
    scan.T_map_sensor_at_column.push_back(self.T_map_world * pose);
  }
  if (self.next_scan == 0) scan.T_map_sensor = Pose::Identity();
  ++self.next_scan;
  return scan;
}

}  // namespace hqslam::sim
