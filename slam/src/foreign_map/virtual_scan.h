#pragma once

#include <vector>

#include "foreign_map/surfels.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// The sensor that looks around in a cloud for another one: the same field of view, at least 64
/// rows and 1,024 columns, and no farther than scan contexts reach.
SensorModel virtual_sensor(const SensorModel& sensor);

/// What such a sensor would measure of surfaces where it stands still: the nearest surfel on each
/// pixel's beam, at the distance of its plane. Surfels within 25 m are fine ones (0.1 m), those
/// beyond coarse (0.3 m): there a pixel is as large.
class VirtualScanner {
 public:
  VirtualScanner(const SensorModel& sensor, const SurfelTiles& fine, const SurfelTiles& coarse);

  OrganizedCloud scan(const Pose& T_map_sensor) const;

 private:
  void draw(const Surfel& surfel, OrganizedCloud& cloud) const;

  SensorModel sensor_;
  const SurfelTiles& fine_;
  const SurfelTiles& coarse_;
  std::vector<Eigen::Vector3f> beams_;  ///< rows x columns
};

/// The rows of a virtual scan that look most as the beams of the real sensor do: what a place looks
/// like depends on how many rows see it.
OrganizedCloud with_rows_of(const SensorModel& sensor, const OrganizedCloud& scan,
                            const SensorModel& seen_by);

}  // namespace hqslam::slam
