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

/// How the sensor sits on what carries it.
struct SensorMount {
  double sensor_height_m = 1.85;  ///< above the ground beneath it; 0.1 to 10
  /// Added to the roll and pitch of what carries it; -180 to 180 (upside down) and -45 to 45
  /// degrees. Positive roll raises the left side, positive pitch lowers the front.
  double mount_roll_rad = 0.0;
  double mount_pitch_rad = 0.0;

  bool operator==(const SensorMount&) const = default;
};

/// What makes the sensor see worse than on a clear day; src/lidar.h has the formulas.
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
/// Raised whenever the same spec begins to give other ranges or poses, which are what is stored
/// under it.
constexpr int kDriveRevision = 2;
/// Throws Error with field, value and constraint.
void validate(const DriveSpec& spec);

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
  /// Of each pixel, as a calibrated sensor reports it: reflectivity in percent up to 100, above
  /// it what throws light back; src/lidar.h has the formula. 0 where no return.
  std::vector<std::uint8_t> intensity;
  double stamp_s = 0.0;                  ///< the middle of the scan
  Pose T_map_sensor = Pose::Identity();  ///< true pose at stamp_s; the first scan's is the identity
  /// True pose when the head stands at each column (SensorModel::firing_column).
  std::vector<Pose> T_map_sensor_at_column;
  std::vector<SimulatedImuSample> imu;  ///< since the end of the scan before, skipped ones included
};

/// A part of space above a place: round, from lowest_m to highest_m above the ground.
struct UprightColumn {
  double radius_m = 0.05;
  double lowest_m = 0.25;
  double highest_m = 2.0;
};

/// What there is at a place.
struct TruePlace {
  double ground_m = 0.0;     ///< z of the ground
  bool is_occupied = false;  ///< something that stands still comes into the column above it
};

/// Drives a sensor through the city, one scan after the other; never more than one in memory.
class DriveSimulator {
 public:
  DriveSimulator(const DriveSpec& spec, const SensorModel& sensor);
  ~DriveSimulator();
  DriveSimulator(DriveSimulator&&) noexcept;  ///< moved from: only assign or destroy
  DriveSimulator& operator=(DriveSimulator&&) noexcept;

  const SensorModel& sensor() const;
  std::int64_t scans() const;
  /// rows: only these are simulated, four times as fast for a quarter of them; the others of the
  /// image are empty. (No beam of them then borders on one that is.) Nothing: all rows.
  std::optional<SimulatedScan> next(const std::optional<RowSelection>& rows = std::nullopt);
  /// Leaves out the next `scans` scans without simulating them; those after it stay the same.
  /// Throws Error for a negative number.
  void skip(std::int64_t scans);

  /// Where the beams of the next scan would meet the true surface (map frame, in the order of the
  /// pixels), and goes on to the scan after it: from where the sensor is then, without noise and
  /// drop-outs, without those who move, and without glass, which shows what is behind it or
  /// nothing. A beam counts if its surface lies within the sensor's range and is bright enough to
  /// be seen at least every other time.
  std::optional<std::vector<Eigen::Vector3f>> next_visible();
  /// From each point (map frame) to the nearest true surface: metres, infinity where that is
  /// farther than `reach_m` and for points that are not finite. True are the surfaces of what
  /// stands still, and what their windows show to a sensor on this drive (curtains, rooms, seats):
  /// of that the distance along the line of sight from where the sensor was counts, every two
  /// metres of the drive.
  std::vector<float> distances_to_surface_m(const std::vector<Eigen::Vector3f>& points_m,
                                            double reach_m);
  /// What there is above and below each point (map frame), the truth of an occupancy grid: out of
  /// doors, where the lowest surface within 50 m is the ground. Nothing where there is none.
  std::vector<std::optional<TruePlace>> true_places(const std::vector<Eigen::Vector3f>& points_m,
                                                    const UprightColumn& column);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::sim
