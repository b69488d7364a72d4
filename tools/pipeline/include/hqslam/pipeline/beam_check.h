#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/pipeline/pipeline.h"
#include "hqslam/slam/beam_calibration.h"
#include "hqslam/slam/slam.h"

namespace hqslam::pipeline {

/// Path from which beams are calibrated, m, unless another is asked for.
inline constexpr double kCalibrationPath_m = 150.0;

/// Estimates the errors of a sensor's beams while it drives: keeps a scan for each metre of path
/// and calibrates the beams by them (slam::calibrate_beams).
class BeamCheck {
 public:
  /// path_m: how far scans are kept.
  explicit BeamCheck(double path_m = kCalibrationPath_m) : wanted_path_m_(path_m) {}

  /// The scan that `pipeline` has just located. Without effect once is_complete(), and for a scan
  /// of which echoes of fog were left out.
  void add(const OrganizedCloud& recorded, const slam::ScanReport& report,
           const Pipeline& pipeline);
  /// Whether the path is as long as wanted, or tracking was lost: no more scans are kept.
  bool is_complete() const { return is_lost_ || path_m_ >= wanted_path_m_; }
  bool is_lost() const { return is_lost_; }
  double path_m() const { return path_m_; }
  /// The scans that are kept, with the poses and velocities of the trajectory.
  std::vector<slam::LocatedScan> scans(const Trajectory& trajectory) const;

 private:
  double wanted_path_m_;
  double path_m_ = 0.0;
  bool is_lost_ = false;
  std::optional<Eigen::Vector3d> last_m_;
  std::optional<Eigen::Vector3d> last_kept_m_;
  std::vector<OrganizedCloud> clouds_;
  std::vector<std::size_t> pose_of_cloud_;
};

/// Least path that separates errors of beams from those of the poses, m.
inline constexpr double kLeastPathOfErrors_m = 50.0;
/// Whether the corrections are more than noise: surfaces are thinner by 3 % and more. Simulated
/// perfect beams reach 1.7 % on vehicles (54 drives) and 2.8 % in rooms, beams within their makers'
/// specification 2.9 to 38 % (54), a real VLP-16 less than 1 %, a raw HDL-64E 38 %. Elevations that
/// displace points far more than they bring to surfaces are no errors, but the bowl of
/// calibrate_beams(), as hands that walk bend it.
bool has_errors(const slam::BeamCalibration& found);

/// The sensor with corrections for all its rows, added to those that it has. rows: those that
/// `found` is of; nothing: all. A row that is not among them gets the nearest one's.
SensorModel corrected(SensorModel sensor, const std::optional<RowSelection>& rows,
                      const slam::BeamCalibration& found);

/// "the corrections of elevations reach 0.93 degrees, ...", where it is probably another sensor: a
/// raw HDL-64E is 0.47 degrees off its table at most, units within their makers' specification 0.1.
/// Otherwise empty.
std::string complaint_about(const SensorModel& corrected);

}  // namespace hqslam::pipeline
