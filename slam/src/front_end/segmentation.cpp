#include "front_end/segmentation.h"

#include "front_end/ground.h"

namespace hqslam::slam {

Segmenter::Segmenter(const SensorModel& sensor, const GroundOptions& ground,
                     const SegmentationOptions& options)
    : sensor_(sensor),
      ground_(ground),
      options_(options),
      labeler_(sensor, {options.min_angle_rad, true}) {}

Segmentation Segmenter::segment(const OrganizedCloud& cloud, const Eigen::Vector3d& up_of_sensor) {
  const std::vector<std::uint8_t> ground = mark_ground(cloud, sensor_, ground_, up_of_sensor);
  const ConnectedComponents& connected = labeler_.label(range_image(cloud), ground);

  const auto trusted = [&](const Component& component) {
    const int rows = component.last_row - component.first_row + 1;
    return component.pixels >= options_.min_pixels ||
           (component.pixels >= options_.min_pixels_tall && rows >= options_.min_rows_tall);
  };
  Segmentation result;
  for (const Component& component : connected.components) result.clusters += trusted(component);
  result.pixel_class.assign(cloud.range_m.size(), PixelClass::kNoReturn);
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    if (cloud.range_m[i] <= 0.0F) continue;
    ++result.returns;
    if (ground[i] != 0) {
      ++result.ground_points;
      result.pixel_class[i] = PixelClass::kGround;
    } else {
      result.pixel_class[i] = trusted(connected.components[connected.label[i]])
                                  ? PixelClass::kCluster
                                  : PixelClass::kOutlier;
    }
  }
  return result;
}

}  // namespace hqslam::slam
