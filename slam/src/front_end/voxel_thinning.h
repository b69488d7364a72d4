#pragma once

#include <vector>

#include "front_end/features.h"

namespace hqslam::slam {

/// One point per voxel of `leaf_m`: the mean of position, time offset and known intensities, summed
/// in the order of the points. Voxels are in the order of their first points. The row is that of
/// the first point, so it is meaningful only if all points are of one row. Points a million voxels
/// from the origin or farther are left out.
std::vector<FeaturePoint> thin(const std::vector<FeaturePoint>& points, double leaf_m);

}  // namespace hqslam::slam
