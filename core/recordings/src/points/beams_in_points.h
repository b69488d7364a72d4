#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "hqslam/core/point_fields.h"

namespace hqslam::recordings {

/// No sensor has more beams.
inline constexpr int kMostBeams = 256;
/// Fewer points do not determine a beam.
inline constexpr std::size_t kFewestPoints = 30;

/// A point of a beam.
struct Sight {
  std::size_t scan = 0;
  double azimuth_rad = 0.0;
  double slope = 0.0;           ///< tangent of the elevation
  double nearness_per_m = 0.0;  ///< one by the horizontal distance
};
using Sights = std::vector<Sight>;

/// A beam; a point at the horizontal distance r has the slope far_slope + height_m / r.
struct Beam {
  double elevation_rad = 0.0;  ///< on flat ground
  double far_slope = 0.0;      ///< tangent of the elevation
  double height_m = 0.0;
  Sights sights;

  double off_rad(const Sight& sight) const {
    const double off = sight.slope - far_slope - height_m * sight.nearness_per_m;
    return off / (1.0 + sight.slope * sight.slope);
  }
  double elevation_at_rad(double level_m) const {
    return std::atan(far_slope + height_m / level_m);
  }
};

/// The beams of a sensor, highest first.
struct Beams {
  std::vector<Beam> beams;
  double strays = 0.0;   ///< number of points that belong to no beam
  double nearest = 0.5;  ///< share of a beam's spacing within which points belong to it
  /// How many rings their numbers are for, from the smallest to the largest; 0: unknown.
  int rings = 0;
};

/// Beams from the numbers of the rings; none where not all points have one.
Beams beams_by_rings(const std::vector<RawPoints>& scans);
/// Beams from scans stored beam after beam: as many as most of the scans have, else none.
Beams beams_by_order(const std::vector<RawPoints>& scans);
/// Beams from the elevations alone.
Beams beams_by_elevation(const std::vector<RawPoints>& scans);

}  // namespace hqslam::recordings
