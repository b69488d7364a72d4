#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "echo.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"
#include "ray_scene.h"

namespace hqslam::sim {

/// A spinning LiDAR: its rays, their returns, and the measured pixels.
///
/// Signal: a surface of reflectivity rho at range r, met at an incidence angle of cosine c, returns
///   q = rho / 0.8 * max(c, 0.02)^(3/8) * (max_range / r)^2
/// times the power that is just enough half of the time: max_range_m is thus the range at which a
/// bright target, met head-on, is seen every other time. (A Lambertian surface has c to the power
/// of 1; real streets are rough and return more at grazing incidence.)
/// Detection: with probability 0.9985 q^5 / (1 + q^5).
/// Noise: standard deviation 8 mm + 8 mm / sqrt(q) (the latter at most 16 mm).
/// Mixed pixels: where a neighbouring pixel's range differs, the beam's footprint is sampled
/// towards that neighbour too. Echoes closer together than the pulse are one: their mean, weighted
/// by power; otherwise the strongest counts.
/// Glass: some windows have curtains, some show the room behind, some return nothing.
/// Ranges are rounded to 1 mm.
/// The beams of a sensor with errors (SensorErrors) have the directions and range errors of
/// draw_beam_errors, and the PulseErrors of echo.h.
///
/// Rain or fog of extinction a leaves exp(-2 a r) of the signal on its path to the surface and back
/// (Beer-Lambert; here (1 + a r / 8)^-16, whose roundings are the same on every machine). With
/// probability airborne_share a pixel meets drops at r_d = min_range + 12 m u^2, u uniform in
/// [0, 1); if that is nearer than what the pixel would have reported, or it would have reported
/// nothing, r_d is what it reports. Of what is then reported dropout_share is lost, pixel by pixel,
/// and extra_range_noise_m is the standard deviation of noise that is added.
///
/// Intensity: the signal with the range taken out of it, 0.8 q (r / max_range)^2, which of one
/// surface on a clear day is R = rho max(c, 0.02)^(3/8). Reported is 100 R up to R = 1 and 69 + 31
/// R above, 255 at most, as Velodyne calibrates (VLP-16 user manual: to 100 what reflects
/// diffusely, from there to 255 what throws light back). Drops have 2: such clutter is faint
/// (Heinzler et al., "Weather influence and classification with automotive lidar sensors", IV
/// 2019). A sensor with errors reports it times its beam's gain (draw_beam_errors), and scattered
/// (PulseErrors).
class Lidar {
 public:
  /// A sensor with the conditions, the errors and the seed of a drive.
  Lidar(const SensorModel& sensor, const DriveSpec& drive);
  /// One revolution; `T_world_sensor` at every column of the head. Rows that are not selected have
  /// no returns. intensity: set to the intensities in the order of the pixels, 0 where no return.
  RangeImage measure(const RayScene& scene, const std::vector<Pose>& T_world_sensor,
                     std::int64_t scan, RowSelection rows = {},
                     std::vector<std::uint8_t>* intensity = nullptr) const;
  /// Where the beams of one revolution meet surfaces that are within range and bright enough to be
  /// seen at least every other time (q of 1 and more); none behind glass. World frame, in the order
  /// of the pixels.
  std::vector<Eigen::Vector3d> visible_surface_m(const RayScene& scene,
                                                 const std::vector<Pose>& T_world_sensor) const;

 private:
  struct Revolution;

  const SensorModel sensor_;
  const SensingConditions conditions_;
  const BeamErrors beams_;
  const PulseErrors pulse_;
  std::uint64_t seed_;
  std::vector<Eigen::Vector3d>
      directions_;  ///< rows x columns, sensor frame; true ones of the beams
};

}  // namespace hqslam::sim
