#include "memory_projection.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

constexpr float kFallOff = 4.0F;  ///< w = exp(-kFallOff (u^2 + v^2))
constexpr int kWorthParts = 512;
/// What a measured beam passes, and by how much it sees farther.
constexpr float kPassed_pixels = 0.15F;
constexpr float kFarther_m = 0.5F;
constexpr float kFartherShare = 0.05F;

/// atan2 with an error below 2e-4 rad, a thirtieth of a column; without a branch, for points come
/// in no order.
float azimuth_of(float y, float x) {
  const float ax = std::fabs(x);
  const float ay = std::fabs(y);
  const float a = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-20F);
  const float s = a * a;
  const float eighth = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * a + a;
  constexpr float kQuarter = std::numbers::pi_v<float> / 2;
  const float quarter = ay > ax ? kQuarter - eighth : eighth;
  const float half = x < 0.0F ? 2 * kQuarter - quarter : quarter;
  return std::copysign(half, y);
}

}  // namespace

MemoryProjection::MemoryProjection(const SensorModel& sensor)
    : sensor_(sensor),
      columns_per_rad_(static_cast<float>(1.0 / sensor.column_step_rad())),
      least_m_(static_cast<float>(sensor.min_range_m)),
      most_m_(static_cast<float>(sensor.max_range_m)) {
  validate(sensor);
  if (!sensor.measured_rows) {
    throw Error("scan memory: sensor '{}' does not say which of its {} rows are measured",
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
    azimuth_of_edge_.push_back(
        static_cast<float>(sensor_.azimuth_rad(row, 0) + 0.5 * sensor_.column_step_rad()));
    column_shift_.push_back(sensor_.column_shift(row));
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

/// Looked for in the column where the point was seen last, and once more where that is far off.
/// Returns false where it falls into no pixel.
bool MemoryProjection::find_hit(const Eigen::Vector3f& point_m, const std::vector<PoseFloat>& poses,
                                std::int16_t& seen_in_column, Hit& hit) const {
  constexpr int kFar_columns = 4;
  const int columns = sensor_.columns;
  const auto all = static_cast<float>(columns);
  int head = seen_in_column;
  for (bool again = poses.size() > 1;; again = false) {
    const Eigen::Vector3f p = poses[poses.size() > 1 ? head : 0](point_m);
    const float range_m = std::sqrt(p.squaredNorm());
    if (!(range_m >= least_m_ && range_m <= most_m_)) return false;
    const float s = p.z() / range_m;
    const int row = row_of(s);
    // Columns count clockwise, from the left edge of the first.
    float u = (azimuth_of_edge_[row] - azimuth_of(p.y(), p.x())) * columns_per_rad_;
    u += (u < 0.0F ? all : 0.0F) - (u >= all ? all : 0.0F);
    const int column = std::clamp(static_cast<int>(u), 0, columns - 1);
    const int shifted = column + column_shift_[row];
    const int seen_by = shifted + (shifted < 0 ? columns : 0) - (shifted >= columns ? columns : 0);
    const int off = std::abs(seen_by - head);
    head = seen_by;
    if (again && std::min(off, columns - off) > kFar_columns) continue;
    seen_in_column = static_cast<std::int16_t>(head);
    const float down = sine_[row] - s;
    const float v = down * (down > 0.0F ? per_sine_below_[row] : per_sine_above_[row]);
    if (std::fabs(v) > 0.5F) return false;
    const float off_u = std::clamp(u - static_cast<float>(column) - 0.5F, -0.5F, 0.5F);
    hit.row = static_cast<std::int16_t>(row);
    hit.column = static_cast<std::int16_t>(column);
    hit.range_m = range_m;
    hit.u = off_u;
    hit.v = v;
    hit.worth = worth_[static_cast<int>((off_u * off_u + v * v) * (2.0F * kWorthParts))];
    return true;
  }
}

bool MemoryProjection::is_passed(const Hit& hit, const RangeImage& measured) const {
  if (!measured_rows_.contains(hit.row) || std::fabs(hit.v) > kPassed_pixels) return false;
  const float range_m =
      measured.at((hit.row - measured_rows_.offset) / measured_rows_.stride, hit.column);
  return range_m > hit.range_m * (1.0F + kFartherShare) + kFarther_m;
}

/// Hits of one scan's points; those that have moved on are forgotten.
void MemoryProjection::project_scan(KeptScan& scan, const RangeImage& measured,
                                    const std::vector<PoseFloat>& poses, std::vector<Hit>& of_scan,
                                    std::vector<float>& nearest) const {
  of_scan.resize(scan.points_m.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    Hit& hit = of_scan[count];  // written where it stays: to copy it waits for every part of it
    if (!find_hit(scan.points_m[i], poses, scan.columns[i], hit)) continue;
    if (is_passed(hit, measured)) {
      scan.points_m[i].setConstant(NAN);
      continue;
    }
    ++count;
    float& first_m = nearest[pixel_of(hit)];
    first_m = std::min(first_m, hit.range_m);
  }
  of_scan.resize(count);
}

void MemoryProjection::project(std::deque<KeptScan>& kept, const RangeImage& measured,
                               const std::vector<PoseFloat>& poses) {
  hits_.resize(kept.size());
  nearest_m_.assign(static_cast<std::size_t>(sensor_.rows()) * sensor_.columns, HUGE_VALF);
  const auto scans = static_cast<int>(kept.size());
#pragma omp parallel
  {
    std::vector<float> nearest(nearest_m_.size(), HUGE_VALF);
#pragma omp for schedule(dynamic, 1)
    for (int scan = 0; scan < scans; ++scan) {
      std::vector<Hit> own;  // neighbours in `hits_` share a line of the cache
      own.swap(hits_[scan]);
      project_scan(kept[scan], measured, poses, own, nearest);
      own.swap(hits_[scan]);
    }
#pragma omp critical
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      nearest_m_[i] = std::min(nearest_m_[i], nearest[i]);
    }
  }
}

}  // namespace hqslam::nn
