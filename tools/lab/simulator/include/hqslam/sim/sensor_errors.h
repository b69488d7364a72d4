#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hqslam::sim {

/// Deviation of a simulated sensor from its beam table.
enum class SensorErrors { kNone, kTypical, kBad };
/// none, typical, bad.
std::vector<std::string> sensor_errors_names();
std::string name_of(SensorErrors errors);
/// Throws Error that lists the names for any other.
SensorErrors sensor_errors_named(std::string_view name);

/// Constant errors of each beam (row), highest beam first.
struct BeamErrors {
  std::vector<double> range_m;         ///< reported minus true
  std::vector<double> elevation_rad;   ///< true minus the sensor model's
  std::vector<double> azimuth_rad;     ///< true minus the sensor model's, positive to the left
  std::vector<double> intensity_gain;  ///< reported over that of a calibrated beam
};

/// Drawn from a drive's seed, all independent of each other: normally distributed, drawn anew
/// beyond a bound.
///             range             elevation           azimuth            intensity
///   typical   15 mm, to 30 mm   0.05, to 0.1 deg    0.05, to 0.1 deg   1 +- 0.05, to 0.1
///   bad       30 mm, to 60 mm   the same, and 0.3 deg between the      1 +- 0.15, to 0.3
///                               upper and the lower half
/// `none` gives zeros, and gains of 1. Sources: the VLP-16's and the OS1's makers promise 3 cm;
/// factory tables of an HDL-64E are off by some hundredths of a degree and by centimetres, its two
/// blocks of lasers against each other by more (Glennie and Lichti, "Static calibration and
/// analysis of the Velodyne HDL-64E S2", Remote Sensing 2, 2010). That beams report one surface
/// unequally bright, in spite of the maker's table: Levinson and Thrun, "Unsupervised calibration
/// for multi-beam lasers", ISER 2010, who have no one size for it; these are chosen.
BeamErrors draw_beam_errors(SensorErrors errors, int rows, std::uint64_t drive_seed);

}  // namespace hqslam::sim
