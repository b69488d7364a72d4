#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::tools {

/// The baseline of `hqslam bench`: labels a range image as a first version would, with a
/// std::queue, memory of its own on each call and atan2 for each pair of pixels. Neighbours, angle
/// criterion and column wrap are ComponentLabeler's. Returns the label of each pixel, -1 where
/// there is no return.
///
/// The angle between the longer beam and the line through both points (Bogoslavskyi & Stachniss,
/// IROS 2016): atan2(d2 sin(alpha), d1 - d2 cos(alpha)) with d1 >= d2 and alpha between the beams.
std::vector<std::int32_t> textbook_components(const RangeImage& image, const SensorModel& sensor,
                                              double min_angle_rad);

}  // namespace hqslam::tools
