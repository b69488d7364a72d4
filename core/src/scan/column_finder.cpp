#include "scan/column_finder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hqslam {

namespace {

constexpr int kSteps = 256;
constexpr double kNearEdge = 1.0 / 64.0;  // columns

/// atan of 0, 1/256, ..., 1.
std::vector<float> arc_tangents_rad() {
  std::vector<float> values_rad;
  for (int i = 0; i <= kSteps; ++i) {
    values_rad.push_back(static_cast<float>(std::atan(static_cast<double>(i) / kSteps)));
  }
  return values_rad;
}

/// The azimuth to 1.3e-6 rad; not finite where x and y are both 0 or both infinite.
float approximate_azimuth_rad(float x, float y, const std::vector<float>& arc_tangent_rad) {
  constexpr auto kPi = static_cast<float>(std::numbers::pi);
  const float across = std::abs(y);
  const float along = std::abs(x);
  const float at = static_cast<float>(kSteps) * std::min(across, along) / std::max(across, along);
  if (!(at <= static_cast<float>(kSteps))) return at;
  const int step = std::min(static_cast<int>(at), kSteps - 1);
  const float below_rad = arc_tangent_rad[step];
  float azimuth_rad =
      below_rad + (at - static_cast<float>(step)) * (arc_tangent_rad[step + 1] - below_rad);
  if (across > along) azimuth_rad = kPi / 2.0F - azimuth_rad;
  if (x < 0.0F) azimuth_rad = kPi - azimuth_rad;
  return y < 0.0F ? -azimuth_rad : azimuth_rad;
}

}  // namespace

ColumnFinder::ColumnFinder(const SensorModel& sensor)
    : sensor_(sensor),
      columns_per_rad_(1.0 / sensor.column_step_rad()),
      arc_tangent_rad_(arc_tangents_rad()) {
  for (int row = 0; row < sensor.rows(); ++row) {
    residual_azimuth_rad_.push_back(sensor.residual_azimuth_rad(row));
  }
}

int ColumnFinder::column(int row, const Eigen::Vector3f& point_m) const {
  const double azimuth_rad = approximate_azimuth_rad(point_m.x(), point_m.y(), arc_tangent_rad_) -
                             residual_azimuth_rad_[row];
  const double position = 0.5 * sensor_.columns - azimuth_rad * columns_per_rad_;
  if (position > kNearEdge && position < sensor_.columns - kNearEdge) {
    const int column = static_cast<int>(position);
    const double within = position - column;
    if (within > kNearEdge && within < 1.0 - kNearEdge) return column;
  }
  return sensor_.column_of_azimuth(std::atan2(point_m.y(), point_m.x()) -
                                   residual_azimuth_rad_[row]);
}

}  // namespace hqslam
