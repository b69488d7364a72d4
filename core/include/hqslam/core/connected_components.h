#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// One connected component.
struct Component {
  std::int32_t pixels = 0;
  std::int32_t first_row = 0;  ///< smallest row index (highest beam) of any pixel
  std::int32_t last_row = 0;
};

/// label[i] of pixel i indexes `components`; kNoComponent where there is no return or the pixel was
/// masked out. Components are numbered in the order of their first pixel, row-major.
struct ConnectedComponents {
  static constexpr std::int32_t kNoComponent = -1;
  std::vector<std::int32_t> label;
  std::vector<Component> components;
};

/// Labels a range image by breadth-first search over N4 neighbours (the last column is one of the
/// first); linear in the number of pixels, no recursion. One object serves many images of one
/// sensor: after the first call no call allocates.
class ComponentLabeler {
 public:
  /// Two neighbouring pixels belong to one surface if the angle between the longer beam and the
  /// line through both points is larger than `min_angle_rad`: 10 degrees for outliers (Bogoslavskyi
  /// & Stachniss' default), 60 degrees for segmentation (LeGO-LOAM). Throws Error unless 0 <
  /// min_angle_rad < pi/2.
  ComponentLabeler(const SensorModel& sensor, double min_angle_rad);

  /// `excluded`, if not empty, holds one value per pixel; non-zero pixels (such as ground) are left
  /// out. Throws Error if a shape differs from the sensor's. The result is valid until the next
  /// call.
  const ConnectedComponents& label(const RangeImage& image,
                                   const std::vector<std::uint8_t>& excluded = {});

  /// Whether two neighbouring ranges, seen under the angle with this sine and cosine, connect.
  static bool connected(float range_a_m, float range_b_m, float sin_alpha, float cos_alpha,
                        float tan_min_angle) {
    const float farther_m = range_a_m > range_b_m ? range_a_m : range_b_m;
    const float nearer_m = range_a_m > range_b_m ? range_b_m : range_a_m;
    return nearer_m * sin_alpha > tan_min_angle * (farther_m - nearer_m * cos_alpha);
  }

 private:
  /// Labels the component of pixel `start`, which must be unvisited.
  Component grow(const float* range_m, std::int32_t start);

  int rows_;
  int columns_;
  float tan_min_angle_;
  float horizontal_sin_;
  float horizontal_cos_;
  std::vector<float> vertical_sin_;  ///< between row r and r + 1
  std::vector<float> vertical_cos_;
  std::vector<std::int32_t> queue_;
  ConnectedComponents result_;
};

}  // namespace hqslam
