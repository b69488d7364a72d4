#include "memory_projection.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

constexpr float kFallOff = 4.0F;  ///< w = exp(-kFallOff (u^2 + v^2))
constexpr int kWorthParts = 512;
/// How much longer the range of a beam is than that of a point that it passes.
constexpr float kFarther_m = 0.5F;
constexpr float kFartherShare = 0.05F;

/// The least-squares cubic through a value of each column: its terms are this times the values.
Eigen::Matrix<double, 4, Eigen::Dynamic> cubic_through(int columns) {
  Eigen::Matrix<double, Eigen::Dynamic, 4> powers(columns, 4);
  for (int column = 0; column < columns; ++column) {
    const double h = (column + 0.5) * 2.0 / columns - 1.0;
    powers.row(column) << 1.0, h, h * h, h * h * h;
  }
  return (powers.transpose() * powers).ldlt().solve(powers.transpose());
}

/// Where a turn begins: at the column whose pose is farthest from that of the column before it, all
/// round. A turn by a tenth of a radian counts as a metre.
int first_column_of(const std::vector<Pose>& T_world_sensor) {
  const auto columns = static_cast<int>(T_world_sensor.size());
  int first = 0;
  double farthest = 0.0;
  for (int column = 0; column < columns; ++column) {
    const Pose& before = T_world_sensor[(column + columns - 1) % columns];
    const Pose& here = T_world_sensor[column];
    // |R - R'|^2 is twice the square of a small angle between them.
    const double step = (here.translation() - before.translation()).squaredNorm() +
                        50.0 * (here.linear() - before.linear()).squaredNorm();
    if (step <= farthest) continue;
    farthest = step;
    first = column;
  }
  return first;
}

}  // namespace

MemoryProjection::MemoryProjection(const SensorModel& sensor)
    : sensor_(sensor),
      kernels_(kernels::row_kernels(chosen_instruction_set())),
      least_m_(static_cast<float>(sensor.min_range_m)),
      most_m_(static_cast<float>(sensor.max_range_m)) {
  validate(sensor);
  cubic_through_columns_ = cubic_through(sensor.columns);
  if (!sensor.measured_rows) {
    throw Error(
        "scan memory: sensor '{}' has {} rows without measured_rows, expected those that are "
        "measured",
        sensor.name, sensor.rows());
  }
  measured_rows_ = *sensor.measured_rows;
  if (sensor.rows() < 2) {
    throw Error("scan memory: sensor '{}' has 1 row, expected at least 2", sensor.name);
  }
  for (int i = 0; i <= kWorthParts; ++i) {
    worth_[i] = std::exp(-kFallOff * 0.5F * (static_cast<float>(i) + 0.5F) / kWorthParts);
  }
  for (int row = 0; row < sensor_.rows(); ++row) {
    sine_.push_back(static_cast<float>(std::sin(sensor_.beam_elevation_rad[row])));
    const double edge = sensor_.azimuth_rad(row, 0) / sensor_.column_step_rad() + 0.5;
    edge_.push_back(static_cast<float>(edge));
    head_offset_.push_back(static_cast<float>(edge + sensor_.column_shift(row)));
  }
  for (int row = 0; row < sensor_.rows(); ++row) {
    const int last = sensor_.rows() - 1;
    const float above = sine_[std::max(row - 1, 0)] - sine_[std::max(row, 1)];
    const float below = sine_[std::min(row, last - 1)] - sine_[std::min(row + 1, last)];
    per_sine_above_.push_back(1.0F / above);
    per_sine_below_.push_back(1.0F / below);
  }
  for (int row = 0; row + 1 < sensor_.rows(); ++row) {
    lower_edge_.push_back(0.5F * (sine_[row] + sine_[row + 1]));
  }
  lower_edge_.push_back(-2.0F);
  const auto measured = std::ssize(selected_rows(sensor_.rows(), measured_rows_));
  for (int row = 0, above = -1; row < sensor_.rows(); ++row) {
    if (measured_rows_.contains(row) && above + 1 < measured) ++above;
    measured_above_.push_back(above);
  }
  for (int band = 0; band < kBands; ++band) {
    band_.resize(sensor_.rows() * (band + 1) / kBands, static_cast<std::int16_t>(band));
  }
  constexpr int kParts = 16384;  // so narrow that no part has the edges of two rows
  int row = sensor_.rows() - 1;
  for (int part = 0; part < kParts; ++part) {
    const float top = static_cast<float>(part + 1) * (2.0F / (kParts - 1)) - 1.0F;
    while (row > 0 && top >= lower_edge_[row - 1]) --row;
    row_of_sine_.push_back(static_cast<std::int16_t>(row));
  }
}

/// The row whose elevation is nearest: the table's, or the next below.
int MemoryProjection::row_of(float s) const {
  const auto parts = static_cast<float>(row_of_sine_.size());
  const int row = row_of_sine_[static_cast<int>((s + 1.0F) * 0.5F * (parts - 1.0F))];
  return row + (s < lower_edge_[row] ? 1 : 0);
}

/// Returns false where a point falls into no pixel.
bool MemoryProjection::find_hit(float range_m, float sine, float turn, Hit& hit) const {
  if (!(range_m >= least_m_ && range_m <= most_m_)) return false;
  const int row = row_of(sine);
  const float down = sine_[row] - sine;
  const float v = down * (down > 0.0F ? per_sine_below_[row] : per_sine_above_[row]);
  if (std::fabs(v) > 0.5F) return false;
  // Columns count clockwise, from the left edge of the first.
  const auto all = static_cast<float>(sensor_.columns);
  const float once = edge_[row] - turn;
  const float from_edge = once + (once < 0.0F ? all : 0.0F) - (once >= all ? all : 0.0F);
  const int column = std::clamp(static_cast<int>(from_edge), 0, sensor_.columns - 1);
  const float u = std::clamp(from_edge - static_cast<float>(column) - 0.5F, -0.5F, 0.5F);
  hit = {static_cast<std::int16_t>(row),
         static_cast<std::int16_t>(column),
         range_m,
         u,
         v,
         worth_[static_cast<int>((u * u + v * v) * (2.0F * kWorthParts))]};
  return true;
}

/// Whether a measured beam passes the point, or between two of them both and those beside them.
bool MemoryProjection::is_passed(const Hit& hit, const RangeImage& measured) const {
  const float passed_m = hit.range_m * (1.0F + kFartherShare) + kFarther_m;
  const int above = measured_above_[hit.row];
  const bool is_measured =
      above >= 0 && hit.row == measured_rows_.offset + above * measured_rows_.stride;
  if (is_measured) return measured.at(above, hit.column) > passed_m;
  if (above < 0 || above + 1 >= measured.rows) return false;
  const int last = sensor_.columns - 1;
  const int left = hit.column > 0 ? hit.column - 1 : last;
  const int right = hit.column < last ? hit.column + 1 : 0;
  for (const int column : {left, int{hit.column}, right}) {
    if (!(measured.at(above, column) > passed_m)) return false;
    if (!(measured.at(above + 1, column) > passed_m)) return false;
  }
  return true;
}

/// Finds the hits of one scan's points; points that have moved are forgotten.
void MemoryProjection::project_scan(KeptScan& scan, const RangeImage& measured,
                                    const HeadMotion& motion, Bands& bands,
                                    std::vector<float>& nearest) const {
  constexpr int kAtOnce = 512;  // stay in the first cache
  std::array<float, kAtOnce> range_m;
  std::array<float, kAtOnce> sine;
  std::array<float, kAtOnce> turn;
  for (std::size_t first = 0; first < scan.x_m.size(); first += kAtOnce) {
    const auto count = static_cast<int>(std::min<std::size_t>(kAtOnce, scan.x_m.size() - first));
    kernels_.see_points({&scan.x_m[first], &scan.y_m[first], &scan.z_m[first],
                         &scan.head_offset[first], motion.elements.data(),
                         static_cast<float>(sensor_.columns), motion.first_column, range_m.data(),
                         sine.data(), turn.data(), count});
    for (int i = 0; i < count; ++i) {
      Hit hit;
      if (!find_hit(range_m[i], sine[i], turn[i], hit)) continue;
      if (is_passed(hit, measured)) {
        scan.x_m[first + i] = NAN;
        continue;
      }
      scan.head_offset[first + i] = head_offset_[hit.row];
      float& first_m = nearest[pixel_of(hit)];
      first_m = std::min(first_m, hit.range_m);
      bands[band_[hit.row]].push_back(hit);
    }
  }
}

/// The error of a cubic for an even turn is of the fourth order in its angle: at 200 degrees a
/// second some 1e-5 of the range.
HeadMotion MemoryProjection::motion_through(const std::vector<Pose>& T_world_sensor,
                                            const Eigen::Vector3d& origin_m) const {
  const auto columns = static_cast<int>(T_world_sensor.size());
  const int first = first_column_of(T_world_sensor);
  Eigen::Matrix<double, 12, Eigen::Dynamic> elements(12, columns);
  for (int i = 0; i < columns; ++i) {
    const Pose& pose = T_world_sensor[(first + i) % columns];
    // Column by column R is its inverse row by row.
    elements.col(i) << pose.linear().reshaped(), pose.translation() - origin_m;
  }
  Eigen::Matrix<double, 12, 4> terms = Eigen::Matrix<double, 12, 4>::Zero();
  if (columns == 1) {
    terms.col(0) = elements;
  } else {
    terms = elements * cubic_through_columns_.transpose();
  }
  HeadMotion motion;
  motion.first_column = static_cast<float>(2 * first < columns ? first : first - columns);
  for (int e = 0; e < 12; ++e) {
    for (int k = 0; k < 4; ++k) motion.elements[e][k] = static_cast<float>(terms(e, k));
  }
  return motion;
}

void MemoryProjection::project(std::deque<KeptScan>& kept, const RangeImage& measured,
                               const std::vector<Pose>& T_world_sensor,
                               const Eigen::Vector3d& origin_m, std::optional<double> itself_s) {
  const HeadMotion motion = motion_through(T_world_sensor, origin_m);
  hits_.resize(kept.size());
  nearest_m_.assign(static_cast<std::size_t>(sensor_.rows()) * sensor_.columns, HUGE_VALF);
  const auto scans = static_cast<int>(kept.size());
#pragma omp parallel
  {
    std::vector<float> nearest(nearest_m_.size(), HUGE_VALF);
#pragma omp for schedule(dynamic, 1)
    for (int scan = 0; scan < scans; ++scan) {
      for (std::vector<Hit>& hits : hits_[scan]) hits.clear();
      if (kept[scan].stamp_s == itself_s) continue;
      project_scan(kept[scan], measured, motion, hits_[scan], nearest);
    }
#pragma omp critical
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      nearest_m_[i] = std::min(nearest_m_[i], nearest[i]);
    }
  }
}

}  // namespace hqslam::nn
