#include "hqslam/nn/scan_memory.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <numbers>

#include "hqslam/core/error.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

constexpr float kWorthOfCentre = 4.0F;  ///< W^2 of one point through a pixel's centre
constexpr float kFallOff = 4.0F;        ///< w = exp(-kFallOff (u^2 + v^2))
constexpr float kRidge = 0.04F;         ///< against slopes that few points tell
/// Points of one surface, behind the nearest one: so much, and what a wall that leans by 70 degrees
/// or the level ground spans in a pixel.
constexpr float kSurface_m = 0.15F;
constexpr float kLeaningWall = 2.75F;  ///< tan 70 degrees
constexpr float kLargestGroundShare = 0.15F;
/// What a measured beam passes, and by how much it sees farther.
constexpr float kPassed_pixels = 0.15F;
constexpr float kFarther_m = 0.5F;
constexpr float kFartherShare = 0.05F;
/// World coordinates are kept relative to an origin at most so far away: floats tell 0.1 mm there.
constexpr double kFarFromOrigin_m = 1000.0;

struct PoseFloat {
  Eigen::Matrix3f R_sensor_world;
  Eigen::Vector3f position_m;

  Eigen::Vector3f operator()(const Eigen::Vector3f& p) const {
    return R_sensor_world * (p - position_m);
  }
};

/// exp(-kFallOff d2) for squared distances of up to 1/2, to 0.2 %.
class WorthTable {
 public:
  WorthTable() {
    for (int i = 0; i <= kParts; ++i) {
      values_[i] = std::exp(-kFallOff * 0.5F * (static_cast<float>(i) + 0.5F) / kParts);
    }
  }
  float operator()(float d2) const { return values_[static_cast<int>(d2 * (2.0F * kParts))]; }

 private:
  static constexpr int kParts = 512;
  std::array<float, kParts + 1> values_{};
};

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

struct KeptScan {
  double stamp_s = 0.0;
  Pose T_world_sensor;
  double path_m = 0.0;                    ///< since the first scan of all
  std::vector<Eigen::Vector3f> points_m;  ///< world frame, relative to the origin; NaN: forgotten
  /// Of each point, the head's in the scan that saw or recalled it last: where the next looks
  /// first.
  std::vector<std::int16_t> columns;
};

/// Where a point falls.
struct Hit {
  std::int16_t row = 0;
  std::int16_t column = 0;
  float range_m = 0.0F;
  float u = 0.0F;  ///< from the pixel's centre to the right, in columns
  float v = 0.0F;  ///< downwards, in rows
  float worth = 0.0F;
};

/// Of the points of a pixel: weighted sums of 1, u, v, their squares and products, and with q.
struct PixelSums {
  float w = 0.0F, u = 0.0F, v = 0.0F, q = 0.0F;
  float uu = 0.0F, uv = 0.0F, vv = 0.0F, uq = 0.0F, vq = 0.0F;

  void add(const Hit& hit, float of_q) {
    const float wu = hit.worth * hit.u;
    const float wv = hit.worth * hit.v;
    w += hit.worth;
    u += wu;
    v += wv;
    q += hit.worth * of_q;
    uu += wu * hit.u;
    uv += wu * hit.v;
    vv += wv * hit.v;
    uq += wu * of_q;
    vq += wv * of_q;
  }
  /// The plane through them at the pixel's centre.
  float at_centre() const {
    const float mean_u = u / w;
    const float mean_v = v / w;
    const float mean_q = q / w;
    const float a = uu - u * mean_u + kRidge;
    const float b = uv - u * mean_v;
    const float c = vv - v * mean_v + kRidge;
    const float d = uq - u * mean_q;
    const float e = vq - v * mean_q;
    const float determinant = a * c - b * b;
    return mean_q - ((c * d - b * e) * mean_u + (a * e - b * d) * mean_v) / determinant;
  }
};

}  // namespace

void validate(const ScanMemoryOptions& options) {
  check_field("scan memory: scans", options.scans, 1, 200);
  const auto check = [](bool good, const char* field, double value, const char* expected) {
    check_that(good, "scan memory", field, value, expected);
  };
  check(options.path_m > 0.0, "path_m", options.path_m, "above 0");
  check(options.time_s > 0.0, "time_s", options.time_s, "above 0");
  check(options.step_m >= 0.0, "step_m", options.step_m, "at least 0");
  check(options.step_rad >= 0.0, "step_rad", options.step_rad, "at least 0");
}

struct ScanMemory::Implementation {
  Implementation(const SensorModel& sensor_, const ScanMemoryOptions& options_);

  /// Throws Error.
  void check(int rows, int columns, std::size_t pixels, const ColumnPoses& poses) const;
  int row_of(float sine) const;
  bool find_hit(const Eigen::Vector3f& point_m, const std::vector<PoseFloat>& poses,
                std::int16_t& seen_in_column, Hit& hit) const;
  std::size_t pixel_of(const Hit& hit) const {
    return static_cast<std::size_t>(hit.row) * sensor.columns + hit.column;
  }
  bool is_passed(const Hit& hit, const RangeImage& measured) const;
  void project(const RangeImage& measured, const std::vector<PoseFloat>& poses);
  void project_scan(KeptScan& scan, const RangeImage& measured, const std::vector<PoseFloat>& poses,
                    std::vector<Hit>& of_scan, std::vector<float>& nearest) const;
  void fill(RecalledImage& recalled) const;
  void fill_rows(int first, int end, RecalledImage& recalled) const;
  std::vector<PoseFloat> in_floats(const ColumnPoses& poses) const;
  void move_origin(const Eigen::Vector3d& to_m);

  SensorModel sensor;
  RowSelection measured_rows;
  ScanMemoryOptions options;
  std::vector<float> sine;             ///< of each row's elevation, falling
  std::vector<float> azimuth_of_edge;  ///< of the left edge of column 0, of each row
  std::vector<int> column_shift;       ///< SensorModel::column_shift of each row
  std::vector<float> per_sine_above;   ///< rows a unit of sine, towards the row above
  std::vector<float> per_sine_below;
  std::vector<float> surface_share;       ///< of the range, that one surface spans in each row
  std::vector<float> lower_edge;          ///< the sine between each row and the next
  std::vector<std::int16_t> row_of_sine;  ///< of the upper end of each part of -1 to 1
  float columns_per_rad;
  float least_m;
  float most_m;
  std::deque<KeptScan> kept;
  double path_m = 0.0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  WorthTable worth;
  std::vector<std::vector<Hit>> hits;  ///< of each kept scan
  std::vector<float> nearest_m;        ///< of the hits of each pixel
};

ScanMemory::Implementation::Implementation(const SensorModel& sensor_,
                                           const ScanMemoryOptions& options_)
    : sensor(sensor_),
      options(options_),
      columns_per_rad(static_cast<float>(1.0 / sensor_.column_step_rad())),
      least_m(static_cast<float>(sensor_.min_range_m)),
      most_m(static_cast<float>(sensor_.max_range_m)) {
  hqslam::validate(sensor);
  nn::validate(options);
  if (!sensor.measured_rows) {
    throw Error("scan memory: sensor '{}' does not say which of its {} rows are measured",
                sensor.name, sensor.rows());
  }
  measured_rows = *sensor.measured_rows;
  if (sensor.rows() < 2) {
    throw Error("scan memory: sensor '{}' has 1 row, expected at least 2", sensor.name);
  }
  for (int row = 0; row < sensor.rows(); ++row) {
    sine.push_back(static_cast<float>(std::sin(sensor.beam_elevation_rad[row])));
    azimuth_of_edge.push_back(
        static_cast<float>(sensor.azimuth_rad(row, 0) + 0.5 * sensor.column_step_rad()));
    column_shift.push_back(sensor.column_shift(row));
  }
  for (int row = 0; row < sensor.rows(); ++row) {
    const int last = sensor.rows() - 1;
    const float above = sine[std::max(row - 1, 0)] - sine[std::max(row, 1)];
    const float below = sine[std::min(row, last - 1)] - sine[std::min(row + 1, last)];
    per_sine_above.push_back(1.0F / above);
    per_sine_below.push_back(1.0F / below);
    const float ground =
        sine[row] < 0.0F ? std::min(above / -sine[row], kLargestGroundShare) : 0.0F;
    surface_share.push_back(kLeaningWall * static_cast<float>(sensor.column_step_rad()) + ground);
  }
  for (int row = 0; row + 1 < sensor.rows(); ++row) {
    lower_edge.push_back(0.5F * (sine[row] + sine[row + 1]));
  }
  lower_edge.push_back(-2.0F);
  constexpr int kParts = 16384;  // so narrow that no part has the edges of two rows
  int row = sensor.rows() - 1;
  for (int part = 0; part < kParts; ++part) {
    const float top = static_cast<float>(part + 1) * (2.0F / (kParts - 1)) - 1.0F;
    while (row > 0 && top >= lower_edge[row - 1]) --row;
    row_of_sine.push_back(static_cast<std::int16_t>(row));
  }
}

void ScanMemory::Implementation::check(int rows, int columns, std::size_t pixels,
                                       const ColumnPoses& poses) const {
  const int expected = select_rows(sensor, measured_rows).rows();
  const std::size_t all = static_cast<std::size_t>(expected) * sensor.columns;
  if (rows != expected || columns != sensor.columns || pixels != all) {
    throw Error(
        "scan memory: a scan of {} x {} with {} pixels, expected the measured {} x {} of {}", rows,
        columns, pixels, expected, sensor.columns, sensor.name);
  }
  if (poses.size() == 1 || std::ssize(poses) == sensor.columns) return;
  throw Error("scan memory: {} poses, expected 1 or one for each of the {} columns of {}",
              poses.size(), sensor.columns, sensor.name);
}

/// The row whose elevation is nearest: the table's, or the next below.
int ScanMemory::Implementation::row_of(float s) const {
  const auto parts = static_cast<float>(row_of_sine.size());
  const int row = row_of_sine[static_cast<int>((s + 1.0F) * 0.5F * (parts - 1.0F))];
  return row + (s < lower_edge[row] ? 1 : 0);
}

/// Looked for in the column where the point was seen last, and once more where that is far off.
/// Returns false where it falls into no pixel.
bool ScanMemory::Implementation::find_hit(const Eigen::Vector3f& point_m,
                                          const std::vector<PoseFloat>& poses,
                                          std::int16_t& seen_in_column, Hit& hit) const {
  constexpr int kFar_columns = 4;
  const int columns = sensor.columns;
  const auto all = static_cast<float>(columns);
  int head = seen_in_column;
  for (bool again = poses.size() > 1;; again = false) {
    const Eigen::Vector3f p = poses[poses.size() > 1 ? head : 0](point_m);
    const float range_m = std::sqrt(p.squaredNorm());
    if (!(range_m >= least_m && range_m <= most_m)) return false;
    const float s = p.z() / range_m;
    const int row = row_of(s);
    // Columns count clockwise, from the left edge of the first.
    float u = (azimuth_of_edge[row] - azimuth_of(p.y(), p.x())) * columns_per_rad;
    u += (u < 0.0F ? all : 0.0F) - (u >= all ? all : 0.0F);
    const int column = std::clamp(static_cast<int>(u), 0, columns - 1);
    const int shifted = column + column_shift[row];
    const int seen_by = shifted + (shifted < 0 ? columns : 0) - (shifted >= columns ? columns : 0);
    const int off = std::abs(seen_by - head);
    head = seen_by;
    if (again && std::min(off, columns - off) > kFar_columns) continue;
    seen_in_column = static_cast<std::int16_t>(head);
    const float down = sine[row] - s;
    const float v = down * (down > 0.0F ? per_sine_below[row] : per_sine_above[row]);
    if (std::fabs(v) > 0.5F) return false;
    const float off_u = std::clamp(u - static_cast<float>(column) - 0.5F, -0.5F, 0.5F);
    hit.row = static_cast<std::int16_t>(row);
    hit.column = static_cast<std::int16_t>(column);
    hit.range_m = range_m;
    hit.u = off_u;
    hit.v = v;
    hit.worth = worth(off_u * off_u + v * v);
    return true;
  }
}

bool ScanMemory::Implementation::is_passed(const Hit& hit, const RangeImage& measured) const {
  if (!measured_rows.contains(hit.row) || std::fabs(hit.v) > kPassed_pixels) return false;
  const float range_m =
      measured.at((hit.row - measured_rows.offset) / measured_rows.stride, hit.column);
  return range_m > hit.range_m * (1.0F + kFartherShare) + kFarther_m;
}

/// Hits of one scan's points; those that have moved on are forgotten.
void ScanMemory::Implementation::project_scan(KeptScan& scan, const RangeImage& measured,
                                              const std::vector<PoseFloat>& poses,
                                              std::vector<Hit>& of_scan,
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

void ScanMemory::Implementation::project(const RangeImage& measured,
                                         const std::vector<PoseFloat>& poses) {
  hits.resize(kept.size());
  nearest_m.assign(static_cast<std::size_t>(sensor.rows()) * sensor.columns, HUGE_VALF);
  const auto scans = static_cast<int>(kept.size());
#pragma omp parallel
  {
    std::vector<float> nearest(nearest_m.size(), HUGE_VALF);
#pragma omp for schedule(dynamic, 1)
    for (int scan = 0; scan < scans; ++scan) {
      std::vector<Hit> own;  // neighbours in `hits` share a line of the cache
      own.swap(hits[scan]);
      project_scan(kept[scan], measured, poses, own, nearest);
      own.swap(hits[scan]);
    }
#pragma omp critical
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      nearest_m[i] = std::min(nearest_m[i], nearest[i]);
    }
  }
}

/// M and W^2 of the pixels of some rows, the points in their order.
void ScanMemory::Implementation::fill_rows(int first, int end, RecalledImage& recalled) const {
  std::vector<PixelSums> sums(static_cast<std::size_t>(end - first) * sensor.columns);
  const std::size_t begin = recalled.image.index(first, 0);
  for (const std::vector<Hit>& of_scan : hits) {
    for (const Hit& hit : of_scan) {
      if (hit.row < first || hit.row >= end) continue;
      const std::size_t pixel = pixel_of(hit);
      const float first_m = nearest_m[pixel];
      if (hit.range_m > first_m * (1.0F + surface_share[hit.row]) + kSurface_m) continue;
      sums[pixel - begin].add(hit, first_m / hit.range_m);  // 1/r, with the nearest as its unit
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (!(sums[i].w > 0.0F)) continue;
    recalled.image.range_m[begin + i] =
        nearest_m[begin + i] / std::clamp(sums[i].at_centre(), 0.8F, 1.2F);
    recalled.weight[begin + i] = kWorthOfCentre * sums[i].w;
  }
}

/// Each thread does some of the rows.
void ScanMemory::Implementation::fill(RecalledImage& recalled) const {
  const int rows = sensor.rows();
#pragma omp parallel
  {
    const int thread = omp_get_thread_num();
    const int threads = omp_get_num_threads();
    fill_rows(rows * thread / threads, rows * (thread + 1) / threads, recalled);
  }
}

std::vector<PoseFloat> ScanMemory::Implementation::in_floats(const ColumnPoses& poses) const {
  std::vector<PoseFloat> floats;
  floats.reserve(poses.size());
  for (const Pose& pose : poses) {
    floats.push_back(
        {pose.linear().transpose().cast<float>(), (pose.translation() - origin_m).cast<float>()});
  }
  return floats;
}

void ScanMemory::Implementation::move_origin(const Eigen::Vector3d& to_m) {
  const Eigen::Vector3f step_m = (origin_m - to_m).cast<float>();
  for (KeptScan& scan : kept) {
    for (Eigen::Vector3f& point_m : scan.points_m) point_m += step_m;
  }
  origin_m = to_m;
}

ScanMemory::ScanMemory(const SensorModel& sensor, const ScanMemoryOptions& options)
    : implementation_(std::make_unique<Implementation>(sensor, options)) {}
ScanMemory::~ScanMemory() = default;
ScanMemory::ScanMemory(ScanMemory&&) noexcept = default;
ScanMemory& ScanMemory::operator=(ScanMemory&&) noexcept = default;

RecalledImage ScanMemory::recall(const RangeImage& measured, const ColumnPoses& T_world_sensor) {
  Implementation& self = *implementation_;
  self.check(measured.rows, measured.columns, measured.range_m.size(), T_world_sensor);
  if (self.kept.empty()) return {};
  self.project(measured, self.in_floats(T_world_sensor));
  RecalledImage recalled{RangeImage(self.sensor.rows(), self.sensor.columns), {}};
  recalled.weight.resize(recalled.image.range_m.size());
  self.fill(recalled);
  return recalled;
}

void ScanMemory::insert(const OrganizedCloud& measured, const ColumnPoses& T_world_sensor,
                        double stamp_s) {
  Implementation& self = *implementation_;
  self.check(measured.rows, measured.columns,
             std::min(measured.range_m.size(), measured.points_m.size()), T_world_sensor);
  const Pose& middle = T_world_sensor[T_world_sensor.size() / 2];
  if ((middle.translation() - self.origin_m).norm() > kFarFromOrigin_m) {
    self.move_origin(middle.translation());
  }
  KeptScan scan{stamp_s, middle, self.path_m, {}, {}};
  if (!self.kept.empty()) {
    const Pose step = self.kept.back().T_world_sensor.inverse() * middle;
    scan.path_m = self.path_m = self.kept.back().path_m + step.translation().norm();
    const bool stands = step.translation().norm() < self.options.step_m &&
                        rotation_angle_rad(step) < self.options.step_rad;
    if (stands) self.kept.pop_back();
  }
  for (int row = 0; row < measured.rows; ++row) {
    const int sensor_row = self.measured_rows.offset + row * self.measured_rows.stride;
    for (int column = 0; column < measured.columns; ++column) {
      const std::size_t pixel = measured.index(row, column);
      if (measured.range_m[pixel] <= 0.0F) continue;
      const int head = self.sensor.firing_column(sensor_row, column);
      const Pose& pose = T_world_sensor[T_world_sensor.size() > 1 ? head : 0];
      scan.columns.push_back(static_cast<std::int16_t>(head));
      scan.points_m.emplace_back(
          (pose * measured.points_m[pixel].cast<double>() - self.origin_m).cast<float>());
    }
  }
  self.kept.push_back(std::move(scan));
  while (std::ssize(self.kept) > self.options.scans ||
         self.path_m - self.kept.front().path_m > self.options.path_m ||
         stamp_s - self.kept.front().stamp_s > self.options.time_s) {
    self.kept.pop_front();
  }
}

void ScanMemory::clear() { implementation_->kept.clear(); }

}  // namespace hqslam::nn
