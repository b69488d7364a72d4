#pragma once

#include <string>

#include "hqslam/core/organized_cloud.h"

namespace hqslam::recordings {

/// Gives the sensor of clouds that were thinned out as few columns as they have points, by the
/// first one: single points in an image of the sensor's columns look like fog, and no network was
/// trained for such gaps. Returns a warning that begins with `name`, "" for whole clouds.
std::string fit_columns(const OrganizedCloud& first, const std::string& name, SensorModel& sensor);

}  // namespace hqslam::recordings
