#include "hqslam/nn/scan_memory.h"

#include <algorithm>
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

/// atan2 with an error below 2e-4 rad, a thirtieth of a column, in a fifth of the time.
float azimuth_of(float y, float x) {
  const float ax = std::fabs(x);
  const float ay = std::fabs(y);
  const float a = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-20F);
  const float s = a * a;
  float angle = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * a + a;
  if (ay > ax) angle = std::numbers::pi_v<float> / 2 - angle;
  if (x < 0.0F) angle = std::numbers::pi_v<float> - angle;
  return y < 0.0F ? -angle : angle;
}

struct KeptScan {
  double stamp_s = 0.0;
  Pose T_world_sensor;
  double path_m = 0.0;                    ///< since the first scan of all
  std::vector<Eigen::Vector3f> points_m;  ///< world frame, relative to the origin; NaN: forgotten
};

/// Where a point falls.
struct Hit {
  std::int32_t pixel = -1;  ///< -1: none
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

  void check_poses(const ColumnPoses& poses) const;
  const Pose& pose_at(const ColumnPoses& poses, int row, int column) const {
    return poses.size() == 1 ? poses.front() : poses[sensor.firing_column(row, column)];
  }
  int row_of(float sine) const;
  Hit hit_of(const Eigen::Vector3f& point_m, const std::vector<PoseFloat>& poses) const;
  bool is_passed(const Hit& hit, const RangeImage& measured) const;
  void project(const RangeImage& measured, const std::vector<PoseFloat>& poses);
  void fill(RecalledImage& recalled) const;
  std::vector<PoseFloat> in_floats(const ColumnPoses& poses) const;
  void move_origin(const Eigen::Vector3d& to_m);

  SensorModel sensor;
  RowSelection measured_rows;
  ScanMemoryOptions options;
  std::vector<float> sine;                 ///< of each row's elevation, falling
  std::vector<float> azimuth_of_column_0;  ///< of each row
  std::vector<float> surface_share;        ///< of the range, that one surface spans in each row
  std::vector<std::int16_t> row_of_sine;   ///< the row nearest to each part of -1 to 1
  std::deque<KeptScan> kept;
  double path_m = 0.0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::vector<std::vector<Hit>> hits;  ///< of the points of each kept scan
};

ScanMemory::Implementation::Implementation(const SensorModel& sensor_,
                                           const ScanMemoryOptions& options_)
    : sensor(sensor_), options(options_) {
  hqslam::validate(sensor);
  nn::validate(options);
  if (!sensor.measured_rows) {
    throw Error("scan memory: sensor '{}' does not say which of its {} rows are measured",
                sensor.name, sensor.rows());
  }
  measured_rows = *sensor.measured_rows;
  for (int row = 0; row < sensor.rows(); ++row) {
    sine.push_back(static_cast<float>(std::sin(sensor.beam_elevation_rad[row])));
    azimuth_of_column_0.push_back(static_cast<float>(sensor.azimuth_rad(row, 0)));
  }
  for (int row = 0; row < sensor.rows(); ++row) {
    const int other = row > 0 ? row - 1 : 1;
    const float pitch = std::fabs(sine[row] - sine[other]);
    const float ground =
        sine[row] < 0.0F ? std::min(pitch / -sine[row], kLargestGroundShare) : 0.0F;
    surface_share.push_back(kLeaningWall * static_cast<float>(sensor.column_step_rad()) + ground);
  }
  constexpr int kParts = 8192;
  int row = sensor.rows() - 1;
  for (int part = 0; part < kParts; ++part) {
    const float s = (static_cast<float>(part) + 0.5F) * (2.0F / kParts) - 1.0F;
    while (row > 0 && std::fabs(sine[row - 1] - s) < std::fabs(sine[row] - s)) --row;
    row_of_sine.push_back(static_cast<std::int16_t>(row));
  }
}

void ScanMemory::Implementation::check_poses(const ColumnPoses& poses) const {
  if (poses.size() == 1 || std::ssize(poses) == sensor.columns) return;
  throw Error("scan memory: {} poses, expected 1 or one for each of the {} columns of {}",
              poses.size(), sensor.columns, sensor.name);
}

/// The row whose elevation is nearest, which the table tells up to one.
int ScanMemory::Implementation::row_of(float s) const {
  const auto parts = static_cast<int>(row_of_sine.size());
  const int part = static_cast<int>((s + 1.0F) * 0.5F * static_cast<float>(parts));
  int row = row_of_sine[std::clamp(part, 0, parts - 1)];
  if (row > 0 && std::fabs(sine[row - 1] - s) < std::fabs(sine[row] - s)) --row;
  if (row + 1 < sensor.rows() && std::fabs(sine[row + 1] - s) < std::fabs(sine[row] - s)) ++row;
  return row;
}

Hit ScanMemory::Implementation::hit_of(const Eigen::Vector3f& point_m,
                                       const std::vector<PoseFloat>& poses) const {
  Hit hit;
  const auto column_step = static_cast<float>(sensor.column_step_rad());
  const PoseFloat* pose = &poses[poses.size() / 2];
  for (int pass = 0;; ++pass) {
    const Eigen::Vector3f p = (*pose)(point_m);
    const float range_m = p.norm();
    if (!(range_m >= sensor.min_range_m && range_m <= sensor.max_range_m)) return hit;
    const float s = p.z() / range_m;
    const int row = row_of(s);
    const float off = sine[row] - s;  // positive: below the row's middle
    const int other = off > 0.0F ? row + 1 : row - 1;
    const int inner = std::clamp(other, 0, sensor.rows() - 1) == other ? other : 2 * row - other;
    const float v = off / std::fabs(sine[row] - sine[inner]);
    // Columns count clockwise from the first one's azimuth.
    float u = (azimuth_of_column_0[row] - azimuth_of(p.y(), p.x())) / column_step;
    if (u < -0.5F) u += static_cast<float>(sensor.columns);
    if (u >= static_cast<float>(sensor.columns) - 0.5F) u -= static_cast<float>(sensor.columns);
    const int column = std::clamp(static_cast<int>(std::floor(u + 0.5F)), 0, sensor.columns - 1);
    if (pass == 0 && poses.size() > 1) {
      pose = &poses[sensor.firing_column(row, column)];
      continue;
    }
    if (std::fabs(v) > 0.5F) return hit;
    const float du = u - static_cast<float>(column);
    hit.pixel = row * sensor.columns + column;
    hit.range_m = range_m;
    hit.u = du;
    hit.v = v;
    hit.worth = std::exp(-kFallOff * (du * du + v * v));
    return hit;
  }
}

bool ScanMemory::Implementation::is_passed(const Hit& hit, const RangeImage& measured) const {
  const int row = hit.pixel / sensor.columns;
  if (!measured_rows.contains(row) || std::fabs(hit.v) > kPassed_pixels) return false;
  const float range_m =
      measured.at((row - measured_rows.offset) / measured_rows.stride, hit.pixel % sensor.columns);
  return range_m > hit.range_m * (1.0F + kFartherShare) + kFarther_m;
}

/// Hits of all points; those that have moved on are forgotten.
void ScanMemory::Implementation::project(const RangeImage& measured,
                                         const std::vector<PoseFloat>& poses) {
  hits.resize(kept.size());
  const auto scans = static_cast<int>(kept.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (int scan = 0; scan < scans; ++scan) {
    std::vector<Eigen::Vector3f>& points_m = kept[scan].points_m;
    hits[scan].assign(points_m.size(), Hit());
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      Hit hit = hit_of(points_m[i], poses);
      if (hit.pixel < 0) continue;
      if (is_passed(hit, measured)) {
        points_m[i].setConstant(NAN);
      } else {
        hits[scan][i] = hit;
      }
    }
  }
}

/// M and W^2 of every pixel. Each thread does some of the rows, with the points in their order.
void ScanMemory::Implementation::fill(RecalledImage& recalled) const {
  const int pixels = sensor.rows() * sensor.columns;
  constexpr int kParts = 4;
  std::vector<float> nearest_m(pixels, HUGE_VALF);
  std::vector<PixelSums> sums(pixels);
#pragma omp parallel for schedule(static)
  for (int part = 0; part < kParts; ++part) {
    const int begin = pixels / kParts * part;
    const int end = part + 1 == kParts ? pixels : begin + pixels / kParts;
    const auto for_own_hits = [&](const auto& visit) {
      for (const std::vector<Hit>& of_scan : hits) {
        for (const Hit& hit : of_scan) {
          if (hit.pixel >= begin && hit.pixel < end) visit(hit);
        }
      }
    };
    for_own_hits([&](const Hit& hit) {
      nearest_m[hit.pixel] = std::min(nearest_m[hit.pixel], hit.range_m);
    });
    for_own_hits([&](const Hit& hit) {
      const float first_m = nearest_m[hit.pixel];
      const float share = surface_share[hit.pixel / sensor.columns];
      if (hit.range_m > first_m * (1.0F + share) + kSurface_m) return;
      sums[hit.pixel].add(hit, first_m / hit.range_m);  // 1/r, with the nearest as its unit
    });
    for (int pixel = begin; pixel < end; ++pixel) {
      const PixelSums& sum = sums[pixel];
      if (!(sum.w > 0.0F)) continue;
      recalled.image.range_m[pixel] = nearest_m[pixel] / std::clamp(sum.at_centre(), 0.8F, 1.2F);
      recalled.weight[pixel] = kWorthOfCentre * sum.w;
    }
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
  self.check_poses(T_world_sensor);
  const int rows = select_rows(self.sensor, self.measured_rows).rows();
  if (measured.rows != rows || measured.columns != self.sensor.columns) {
    throw Error("scan memory: a scan of {} x {}, expected the measured {} x {} of {}",
                measured.rows, measured.columns, rows, self.sensor.columns, self.sensor.name);
  }
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
  self.check_poses(T_world_sensor);
  const int rows = select_rows(self.sensor, self.measured_rows).rows();
  if (measured.rows != rows || measured.columns != self.sensor.columns) {
    throw Error("scan memory: a scan of {} x {}, expected the measured {} x {} of {}",
                measured.rows, measured.columns, rows, self.sensor.columns, self.sensor.name);
  }
  const Pose& middle = T_world_sensor[T_world_sensor.size() / 2];
  if ((middle.translation() - self.origin_m).norm() > kFarFromOrigin_m) {
    self.move_origin(middle.translation());
  }
  KeptScan scan{stamp_s, middle, self.path_m, {}};
  if (!self.kept.empty()) {
    const Pose step = self.kept.back().T_world_sensor.inverse() * middle;
    scan.path_m = self.path_m = self.kept.back().path_m + step.translation().norm();
    const bool stands = step.translation().norm() < self.options.step_m &&
                        rotation_angle_rad(step) < self.options.step_rad;
    if (stands) self.kept.pop_back();
  }
  for (int row = 0; row < rows; ++row) {
    const int sensor_row = self.measured_rows.offset + row * self.measured_rows.stride;
    for (int column = 0; column < measured.columns; ++column) {
      const std::size_t pixel = measured.index(row, column);
      if (measured.range_m[pixel] <= 0.0F) continue;
      const Pose& pose = self.pose_at(T_world_sensor, sensor_row, column);
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
