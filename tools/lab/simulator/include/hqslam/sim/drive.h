#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/imu.h"
#include "hqslam/sim/sensor_errors.h"

namespace hqslam::sim {

/// The mounting of the sensor on its carrier.
struct SensorMount {
  double sensor_height_m = 1.85;  ///< above the ground beneath it; 0.1 to 10
  /// Added to the carrier's roll and pitch; -180 to 180 (upside down) and -45 to 45
  /// degrees. Positive roll raises the left side, positive pitch lowers the front.
  double mount_roll_rad = 0.0;
  double mount_pitch_rad = 0.0;

  bool operator==(const SensorMount&) const = default;
};

/// Weather and sensor noise; all zero is a clear day. src/lidar.h has the formulas.
struct SensingConditions {
  double extra_range_noise_m = 0.0;  ///< standard deviation, beside the sensor's own; 0 to 1
  double dropout_share = 0.0;        ///< of the returns that are lost at random; 0 to below 1
  double extinction_per_m = 0.0;     ///< of rain or fog: visibility is about 3.9 over it; 0 to 1
  double airborne_share = 0.0;       ///< of the pixels that meet drops in the air; 0 to 1

  bool operator==(const SensingConditions&) const = default;
};

/// A drive through a procedural city. Everything follows from these fields: the same spec gives
/// the same bytes on every machine, whatever the number of threads.
struct DriveSpec {
  std::string name;        ///< of drive_preset_names(): the style of city and driving
  std::uint64_t seed = 1;  ///< of the city, the traffic, the driver and the sensor's noise
  std::int64_t scans = 200;
  SensorMount mount;
  SensingConditions conditions;
  SensorErrors sensor_errors = SensorErrors::kNone;

  bool operator==(const DriveSpec&) const = default;
};
/// Raised whenever the ranges or poses of the same spec change.
constexpr int kDriveRevision = 2;
/// Throws Error with field, value and constraint.
void validate(const DriveSpec& spec);
/// The specification in a drive.json written by DriveWriter. Throws Error, also for a drive of
/// another revision of the simulator.
DriveSpec read_drive_json(const std::string& path);

/// The same drive with a mount and conditions drawn from its seed: a height of 0.4 to 2.2 m; roll
/// and pitch of up to 5 degrees, mostly below 2; up to 20 mm more noise; up to 6 % drop-outs; rain
/// or fog in one drive of four. Large values are rarer than small ones.
DriveSpec with_varied_conditions(DriveSpec spec);

/// A drive with its usual length and mount. Throws Error that lists the names for any other.
DriveSpec drive_preset(std::string_view name);
/// block, town, hills, ...: see the README.
std::vector<std::string> drive_preset_names();

/// One scan with the truth.
struct SimulatedScan {
  RangeImage image;  ///< rolling capture: column after column, from a moving sensor
  /// Intensity of each pixel as a calibrated sensor reports it: reflectivity in percent up to 100,
  /// retroreflectors above; src/lidar.h has the formula. 0 where no return.
  std::vector<std::uint8_t> intensity;
  double stamp_s = 0.0;                  ///< the middle of the scan
  Pose T_map_sensor = Pose::Identity();  ///< true pose at stamp_s; the first scan's is the identity
  /// True pose when the head stands at each column (SensorModel::firing_column).
  std::vector<Pose> T_map_sensor_at_column;
  std::vector<SimulatedImuSample> imu;  ///< since the end of the scan before, skipped ones included
};

/// Drives a sensor through the city and simulates one scan after the other.
class DriveSimulator {
 public:
  DriveSimulator(const DriveSpec& spec, const SensorModel& sensor);
  ~DriveSimulator();
  DriveSimulator(DriveSimulator&&) noexcept;  ///< moved from: only assign or destroy
  DriveSimulator& operator=(DriveSimulator&&) noexcept;

  const SensorModel& sensor() const;
  std::int64_t scans() const;
  /// rows: the rows to simulate (a quarter of them takes a quarter of the time); the others are
  /// empty, and are no neighbours at depth edges. Nothing: all rows.
  std::optional<SimulatedScan> next(const std::optional<RowSelection>& rows = std::nullopt);
  /// Skips the next `scans` scans; the scans after them do not change.
  /// Throws Error for a negative number.
  void skip(std::int64_t scans);

  /// The points where the beams of the next scan meet the true surface (map frame, in the order of
  /// the pixels), without noise, drop-outs, actors and glass; then advances to the scan after it. A
  /// point counts if it is within the sensor's range and bright enough to be seen at least every
  /// other time.
  std::optional<std::vector<Eigen::Vector3f>> next_visible();
  /// Distance of each point (map frame) from the nearest true surface, metres; infinity where it
  /// exceeds `reach_m` and for points that are not finite. True surfaces are those of standing
  /// things and those that windows show to the sensor on this drive (curtains, rooms, seats), to
  /// which the distance is taken along the line of sight from every second metre of the drive.
  std::vector<float> distances_to_surface_m(const std::vector<Eigen::Vector3f>& points_m,
                                            double reach_m);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::sim
