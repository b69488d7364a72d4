#include "hqslam/core/connected_components.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam {

/// Purpose: labels of surfaces in a range image.
///
/// In: ranges d (rows x columns, metres), the angles alpha between neighbouring beams.
/// Out: a label per pixel, and each component's size and rows.
/// Criterion, for neighbours with ranges d1 >= d2 under the angle alpha: the angle between the
/// longer beam and the line through both points,
///   beta = atan2(d2 sin alpha, d1 - d2 cos alpha),  connected iff beta > theta.
/// Both arguments of atan2 are positive for 0 < alpha < pi/2, so with 0 < theta < pi/2 this is
///   d2 sin alpha > tan theta (d1 - d2 cos alpha),
/// which needs no atan.
/// Source: Bogoslavskyi & Stachniss, IROS 2016; the paper's section on outlier removal.
/// Differs from the original: 32-bit labels (16-bit ones overflow on noisy images), sizes and row
/// spans are collected during the pass, alpha2 < theta separates as in the paper but d1 is always
/// the farther point.

ComponentLabeler::ComponentLabeler(const SensorModel& sensor, double min_angle_rad)
    : rows_(sensor.rows()), columns_(sensor.columns) {
  if (!(min_angle_rad > 0.0 && min_angle_rad < std::numbers::pi / 2.0)) {
    throw Error("connected components: min_angle_rad is {}, expected 0 < angle < pi/2",
                min_angle_rad);
  }
  tan_min_angle_ = static_cast<float>(std::tan(min_angle_rad));
  horizontal_sin_ = static_cast<float>(std::sin(sensor.column_step_rad()));
  horizontal_cos_ = static_cast<float>(std::cos(sensor.column_step_rad()));
  for (int row = 0; row + 1 < rows_; ++row) {
    const double alpha_rad = sensor.beam_elevation_rad[row] - sensor.beam_elevation_rad[row + 1];
    vertical_sin_.push_back(static_cast<float>(std::sin(alpha_rad)));
    vertical_cos_.push_back(static_cast<float>(std::cos(alpha_rad)));
  }
  const std::size_t pixels = static_cast<std::size_t>(rows_) * columns_;
  queue_.resize(pixels);
  result_.label.resize(pixels);
  result_.components.reserve(pixels);
}

namespace {

constexpr std::int32_t kUnvisited = -2;

void require_shapes(const RangeImage& image, const std::vector<std::uint8_t>& excluded, int rows,
                    int columns) {
  if (image.rows != rows || image.columns != columns) {
    throw Error("connected components: image is {}x{}, expected {}x{}", image.rows, image.columns,
                rows, columns);
  }
  if (!excluded.empty() && excluded.size() != image.range_m.size()) {
    throw Error("connected components: mask has {} pixels, expected {}", excluded.size(),
                image.range_m.size());
  }
}

}  // namespace

const ConnectedComponents& ComponentLabeler::label(const RangeImage& image,
                                                   const std::vector<std::uint8_t>& excluded) {
  require_shapes(image, excluded, rows_, columns_);
  const float* range_m = image.range_m.data();
  std::int32_t* label = result_.label.data();
  const auto pixels = static_cast<std::int32_t>(image.range_m.size());
  for (std::int32_t i = 0; i < pixels; ++i) {
    const bool takes_part = range_m[i] > 0.0F && (excluded.empty() || excluded[i] == 0);
    label[i] = takes_part ? kUnvisited : ConnectedComponents::kNoComponent;
  }
  result_.components.clear();
  for (std::int32_t start = 0; start < pixels; ++start) {
    if (label[start] == kUnvisited) result_.components.push_back(grow(range_m, start));
  }
  return result_;
}

Component ComponentLabeler::grow(const float* range_m, std::int32_t start) {
  std::int32_t* label = result_.label.data();
  const auto id = static_cast<std::int32_t>(result_.components.size());
  // Pixels are scanned row-major, so a component is met at its highest row first.
  const std::int32_t first_row = start / columns_;
  Component component{0, first_row, first_row};
  std::int32_t head = 0;
  std::int32_t tail = 0;
  queue_[tail++] = start;
  label[start] = id;
  while (head < tail) {
    const std::int32_t pixel = queue_[head++];
    const std::int32_t row = pixel / columns_;
    const std::int32_t column = pixel - row * columns_;
    component.last_row = std::max(component.last_row, row);
    const auto visit = [&](std::int32_t neighbour, float sin_alpha, float cos_alpha) {
      if (label[neighbour] == kUnvisited &&
          connected(range_m[pixel], range_m[neighbour], sin_alpha, cos_alpha, tan_min_angle_)) {
        label[neighbour] = id;
        queue_[tail++] = neighbour;
      }
    };
    if (row > 0) visit(pixel - columns_, vertical_sin_[row - 1], vertical_cos_[row - 1]);
    if (row + 1 < rows_) visit(pixel + columns_, vertical_sin_[row], vertical_cos_[row]);
    const std::int32_t left = column > 0 ? pixel - 1 : pixel + columns_ - 1;
    const std::int32_t right = column + 1 < columns_ ? pixel + 1 : pixel - columns_ + 1;
    visit(left, horizontal_sin_, horizontal_cos_);
    visit(right, horizontal_sin_, horizontal_cos_);
  }
  component.pixels = tail;
  return component;
}

}  // namespace hqslam
