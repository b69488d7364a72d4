#pragma once

#include <bitset>
#include <cstddef>
#include <vector>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::recordings {

/// Bins of azimuth, 5 degrees each.
inline constexpr int kAzimuthBins = 72;

/// Points of one ring, or of a part of one, in the order of the file.
struct RingSegment {
  std::size_t first = 0;
  std::size_t end = 0;
  bool begins_with_wrap = false;
  double height_rad = 0.0;     ///< elevation relative to the rings before it at equal azimuths
  double elevation_rad = 0.0;  ///< median of its points
  double parallax_rad = 0.0;   ///< error bound of elevation_rad, as lasers may be off the origin
  bool is_sure = false;        ///< whether height_rad was measured at azimuths of earlier rings
  std::bitset<kAzimuthBins> looks_to = {};
};

/// Cuts a scan into segments at each wrap of the azimuth, and at a large gap of the azimuth (the
/// only place where a wrap can hide) if all that follows up to the next wrap is lower. At least
/// one point.
std::vector<RingSegment> ring_segments(const Scan& scan, const SensorModel& sensor);

/// Where the azimuth begins anew, from front or back; without beginnings of less than 3 % of the
/// usual points. At least one for a scan with points.
std::vector<std::size_t> ring_begins(const Scan& scan);

/// Tangent of the elevation of each point: rises with it, at a fraction of the cost. Finite.
std::vector<float> elevation_tangents(const Scan& scan);

/// Distance of each beam to its neighbours.
std::vector<double> beam_spacing_rad(const SensorModel& sensor);
double median_beam_spacing_rad(const SensorModel& sensor);

}  // namespace hqslam::recordings
