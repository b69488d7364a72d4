#pragma once

#include <vector>

#include "foreign_map/surfels.h"
#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// Where a sensor may stand in a cloud: level, 1.7 m above its ground, every four metres.
///
/// The ground is the lowest nearly level surface of each square metre, with nothing between 0.4 m
/// and 2.2 m above it, where it goes on without steps over 0.3 m for at least 50 square metres. Of
/// several storeys it is the lowest.
std::vector<Pose> viewpoints_in(const std::vector<Surfel>& surfels);

}  // namespace hqslam::slam
