#pragma once

#include <string>
#include <vector>

#include "hqslam/core/point_fields.h"
#include "hqslam/core/sensor_finder.h"

namespace hqslam {

/// A .txt or .csv file: a point per line, numbers separated by spaces, tabs, commas or semicolons.
/// A first line may name the columns (x y z, ring or channel, t or time ...); without one they are
/// x y z intensity ring t, of which the first three are required. Lines that begin with # or // are
/// skipped. Throws Error with the line.
RawPoints read_text_points(const std::string& path);

/// A .ply file, ascii or binary_little_endian, whose first element is `vertex`; properties x y z,
/// ring or channel, t or time ..., of any number type, in any order. Throws Error.
RawPoints read_ply_points(const std::string& path);

/// A .pcd file, as read_cloud describes it. Throws Error.
RawPoints read_pcd_points(const std::string& path);

/// The sensor of a recording with one scan per file, determined from some of at least one file. The
/// rate of turning follows from the stamps, else from the points' times. Files that cannot be read
/// are skipped. Throws Error where the points do not determine a sensor.
FoundSensor find_sensor_of_files(const std::vector<std::string>& paths,
                                 const std::vector<double>& stamps_s);

}  // namespace hqslam
