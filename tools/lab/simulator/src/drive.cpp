#include "hqslam/sim/drive.h"

#include <limits>

#include "hqslam/core/error.h"
#include "lidar.h"
#include "random.h"
#include "ray_scene.h"
#include "scenario.h"
#include "true_surface.h"

namespace hqslam::sim {
namespace {

/// The sensor without corrections: a simulated unit agrees with its table, and its images are not
/// corrected for motion.
SensorModel as_made(SensorModel sensor) {
  validate(sensor);
  sensor.elevation_correction_rad.clear();
  sensor.range_correction_m.clear();
  sensor.motion_corrected = false;
  return sensor;
}

}  // namespace

struct DriveSimulator::Implementation {
  Implementation(const DriveSpec& spec_, const SensorModel& sensor_)
      : spec((validate(spec_), spec_)),
        sensor(as_made(sensor_)),
        turns_per_scan(has_streets(spec.name) ? drive_style(spec.name).turns_per_scan : 1),
        scenario(make_scenario(spec, begin_s(spec.scans))),
        scene(*scenario.scenery),
        lidar(sensor, spec),
        imu(spec.seed),
        T_map_world(scenario.T_world_sensor(middle_s(0)).inverse()) {}

  double begin_s(std::int64_t scan) const {
    return static_cast<double>(scan * turns_per_scan) * sensor.scan_period_s;
  }
  double middle_s(std::int64_t scan) const { return begin_s(scan) + 0.5 * sensor.scan_period_s; }
  /// Poses at the times of the columns of the next scan.
  std::vector<Pose> T_world_sensor_at_column() const {
    std::vector<Pose> T_world_sensor;
    for (int column = 0; column < sensor.columns; ++column) {
      const double since_s = sensor.scan_period_s * (column + 0.5) / sensor.columns;
      T_world_sensor.push_back(scenario.T_world_sensor(begin_s(next_scan) + since_s));
    }
    return T_world_sensor;
  }
  /// Positions of the sensor along the drive, every two metres.
  std::vector<Eigen::Vector3d> places_m() const {
    constexpr double kStep_m = 2.0;
    std::vector<Eigen::Vector3d> places_m;
    for (std::int64_t scan = 0; scan < spec.scans; ++scan) {
      const Eigen::Vector3d place_m = scenario.T_world_sensor(middle_s(scan)).translation();
      if (places_m.empty() || (place_m - places_m.back()).norm() >= kStep_m) {
        places_m.push_back(place_m);
      }
    }
    return places_m;
  }

  DriveSpec spec;
  SensorModel sensor;
  int turns_per_scan;
  Scenario scenario;
  RayScene scene;
  Lidar lidar;
  SimulatedImu imu;
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

void DriveSimulator::skip(std::int64_t scans) {
  if (scans < 0) throw Error("skip: {} scans, expected at least 0", scans);
  implementation_->next_scan += scans;
}

std::optional<std::vector<Eigen::Vector3f>> DriveSimulator::next_visible() {
  Implementation& self = *implementation_;
  if (self.next_scan >= self.spec.scans) return std::nullopt;
  self.scene.place_actors({});
  const std::vector<Eigen::Vector3d> seen_m =
      self.lidar.visible_surface_m(self.scene, self.T_world_sensor_at_column());
  ++self.next_scan;
  std::vector<Eigen::Vector3f> visible_m;
  for (const Eigen::Vector3d& point_m : seen_m) {
    visible_m.push_back((self.T_map_world * point_m).cast<float>());
  }
  return visible_m;
}

std::vector<float> DriveSimulator::distances_to_surface_m(
    const std::vector<Eigen::Vector3f>& points_m, double reach_m) {
  Implementation& self = *implementation_;
  self.scene.place_actors({});
  const Pose T_world_map = self.T_map_world.inverse();
  const std::vector<Eigen::Vector3d> places_m = self.places_m();
  std::vector<float> distances_m(points_m.size(), std::numeric_limits<float>::infinity());
#pragma omp parallel for schedule(dynamic, 1024)
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (!points_m[i].allFinite()) continue;
    distances_m[i] = static_cast<float>(distance_to_true_surface_m(
        self.scene, places_m, T_world_map * points_m[i].cast<double>(), reach_m));
  }
  return distances_m;
}

std::optional<SimulatedScan> DriveSimulator::next(const std::optional<RowSelection>& rows) {
  Implementation& self = *implementation_;
  if (self.next_scan >= self.spec.scans) return std::nullopt;
  const double begin_s = self.begin_s(self.next_scan);
  const std::vector<Pose> T_world_sensor = self.T_world_sensor_at_column();
  SimulatedScan scan;
  scan.stamp_s = self.middle_s(self.next_scan);
  const Pose T_world_middle = self.scenario.T_world_sensor(scan.stamp_s);
  self.scene.place_actors(self.scenario.actors(begin_s, begin_s + self.sensor.scan_period_s,
                                               T_world_middle.translation().head<2>()));
  scan.image = self.lidar.measure(self.scene, T_world_sensor, self.next_scan,
                                  rows.value_or(RowSelection{}), &scan.intensity);
  scan.T_map_sensor = self.T_map_world * T_world_middle;
  for (const Pose& pose : T_world_sensor) {
    scan.T_map_sensor_at_column.push_back(self.T_map_world * pose);
  }
  if (self.next_scan == 0) scan.T_map_sensor = Pose::Identity();
  ++self.next_scan;
  // Half a sample's leeway, lest rounding moves a sample at the seam from one scan to the other.
  const double end_s = self.begin_s(self.next_scan) - 0.5 * kImuPeriod_s;
  while (self.imu.next_stamp_s() < end_s) {
    scan.imu.push_back(self.imu.next(self.scenario.T_world_sensor));
  }
  return scan;
}

}  // namespace hqslam::sim
