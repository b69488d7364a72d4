#pragma once

#include <Eigen/Core>
#include <vector>

#include "compare/compare_command.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/evaluation/cloud_error.h"

namespace hqslam::tools {

/// The evaluation of TULIP (Yang et al., CVPR 2024) on KITTI, as its code does it, so that figures
/// can stand beside published ones. What differs from `hqslam-lab compare`'s own: the image has 64
/// even elevations from 2.0 to -24.8 degrees whatever the beams' are, a pixel keeps the point
/// written last, predictions outside 2 to 80 m are emptied, and pixels without a return are points
/// at the sensor.

/// The grid as a sensor with 64 rows of which 3, 7, ..., 63 are measured. Row 0 is the highest and
/// azimuth falls with the column, as everywhere here; TULIP stores both the other way round.
SensorModel tulip_sensor();

/// points_m: one scan, sensor frame, in the order of the file. Out: 64 x 1024, metres;
///   row from below = round((elevation + 24.8) / (26.8 / 63)), elevations in degrees,
///   column (counter-clockwise) = 512 - trunc((atan2(x, y) - 90) / (360 / 1024)), wrapped;
/// points of other rows are dropped, ranges above 120 m become 0.
RangeImage tulip_image(const std::vector<Eigen::Vector3f>& points_m);

/// The cloud that TULIP makes of such an image: a point per pixel, at the origin where there is no
/// return.
std::vector<Eigen::Vector3f> tulip_points_m(const RangeImage& image);

/// Errors of one scan, or sums over several.
struct TulipScore : CloudError {
  /// Over all pixels, the measured rows as the method gives them. Methods here give them as they
  /// were measured, TULIP computes them too.
  double mae_m = 0.0;
  double mae_computed_m = 0.0;  ///< over the 48 rows between them alone
};
/// upsampled: the prediction, measured rows included, metres; truth: tulip_image of the scan.
/// Throws Error if a shape differs.
TulipScore tulip_score(RangeImage upsampled, const RangeImage& truth);

/// In every file that --json writes: tells it from others.
inline constexpr const char* kCompareJsonMarker = R"("written_by": "hqslam-lab compare")";

/// `hqslam-lab compare --protocol tulip`: KITTI .bin files upsampled and scored as is said above.
/// Returns an ExitStatus. Throws Error.
int compare_with_tulip(const CompareOptions& options);

}  // namespace hqslam::tools
