#include "hqslam/nn/scan_memory.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "hqslam/core/error.h"
#include "memory_projection.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

constexpr float kWorthOfCentre = 4.0F;  ///< W^2 of one point through a pixel's centre
constexpr float kRidge = 0.04F;         ///< against slopes that few points determine
/// How far behind the nearest point of a pixel its surface may be: this far, and what a wall at an
/// angle of 70 degrees or the level ground spans in a pixel.
constexpr float kSurface_m = 0.15F;
constexpr float kLeaningWall = 2.75F;  ///< tan 70 degrees
constexpr float kLargestGroundShare = 0.15F;
/// World coordinates are relative to an origin at most this far away: floats resolve 0.1 mm there.
constexpr double kFarFromOrigin_m = 1000.0;

/// Sums over the points of a pixel, weighted: 1, u, v, their squares and products, and with q.
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

void append(KeptScan& scan, const Eigen::Vector3f& point_m, float head_offset) {
  scan.x_m.push_back(point_m.x());
  scan.y_m.push_back(point_m.y());
  scan.z_m.push_back(point_m.z());
  scan.head_offset.push_back(head_offset);
}

/// The share of the range that one surface spans in each row.
std::vector<float> surface_shares(const SensorModel& sensor) {
  const auto sine = [&](int row) {
    return static_cast<float>(std::sin(sensor.beam_elevation_rad[row]));
  };
  std::vector<float> shares;
  for (int row = 0; row < sensor.rows(); ++row) {
    const float above = sine(std::max(row - 1, 0)) - sine(std::max(row, 1));
    const float ground =
        sine(row) < 0.0F ? std::min(above / -sine(row), kLargestGroundShare) : 0.0F;
    shares.push_back(kLeaningWall * static_cast<float>(sensor.column_step_rad()) + ground);
  }
  return shares;
}

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
  Implementation(const SensorModel& sensor_, const ScanMemoryOptions& options_)
      : projection(sensor_),
        sensor(sensor_),
        options(options_),
        surface_share(surface_shares(sensor)) {
    nn::validate(options);
  }

  /// Throws Error.
  void check(int rows, int columns, std::size_t pixels, const ColumnPoses& poses) const;
  void fill_band(int band, RecalledImage& recalled) const;
  RecalledImage surfaces() const;
  void move_origin(const Eigen::Vector3d& to_m);

  MemoryProjection projection;
  SensorModel sensor;
  ScanMemoryOptions options;
  std::vector<float> surface_share;
  std::deque<KeptScan> kept;
  double path_m = 0.0;
  Pose T_world_step;  ///< since when the last scan has not moved on
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
};

void ScanMemory::Implementation::check(int rows, int columns, std::size_t pixels,
                                       const ColumnPoses& poses) const {
  const auto expected = std::ssize(selected_rows(sensor.rows(), *sensor.measured_rows));
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

/// M and W^2 of the pixels of some rows, the points in their order.
void ScanMemory::Implementation::fill_band(int band, RecalledImage& recalled) const {
  const std::size_t begin = recalled.image.index(projection.first_row(band), 0);
  const std::size_t end = recalled.image.index(projection.first_row(band + 1), 0);
  std::vector<PixelSums> sums(end - begin);
  const std::vector<float>& nearest_m = projection.nearest_m();
  for (std::size_t scan = 0; scan < projection.scans(); ++scan) {
    for (const Hit& hit : projection.hits(scan, band)) {
      const std::size_t pixel = projection.pixel_of(hit);
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

RecalledImage ScanMemory::Implementation::surfaces() const {
  RecalledImage recalled{RangeImage(sensor.rows(), sensor.columns), {}};
  recalled.weight.resize(recalled.image.range_m.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (int band = 0; band < MemoryProjection::kBands; ++band) fill_band(band, recalled);
  return recalled;
}

void ScanMemory::Implementation::move_origin(const Eigen::Vector3d& to_m) {
  const Eigen::Vector3f step_m = (origin_m - to_m).cast<float>();
  for (KeptScan& scan : kept) {
    for (float& x_m : scan.x_m) x_m += step_m.x();
    for (float& y_m : scan.y_m) y_m += step_m.y();
    for (float& z_m : scan.z_m) z_m += step_m.z();
  }
  origin_m = to_m;
}

ScanMemory::ScanMemory(const SensorModel& sensor, const ScanMemoryOptions& options)
    : implementation_(std::make_unique<Implementation>(sensor, options)) {}
ScanMemory::~ScanMemory() = default;
ScanMemory::ScanMemory(ScanMemory&&) noexcept = default;
ScanMemory& ScanMemory::operator=(ScanMemory&&) noexcept = default;

RecalledImage ScanMemory::recall(const RangeImage& measured, const ColumnPoses& T_world_sensor,
                                 std::optional<double> itself_s) {
  Implementation& self = *implementation_;
  self.check(measured.rows, measured.columns, measured.range_m.size(), T_world_sensor);
  if (self.kept.empty()) return {};
  self.projection.project(self.kept, measured, T_world_sensor, self.origin_m, itself_s);
  return self.surfaces();
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
  KeptScan scan{stamp_s, middle, self.path_m, {}, {}, {}, {}};
  bool stands = false;
  if (!self.kept.empty()) {
    const KeptScan& last = self.kept.back();
    self.path_m += (middle.translation() - last.T_world_sensor.translation()).norm();
    scan.path_m = self.path_m;
    // Not since the last scan, which may have replaced others: a slow sensor moves on too.
    const Pose step = self.T_world_step.inverse() * middle;
    stands = step.translation().norm() < self.options.step_m &&
             rotation_angle_rad(step) < self.options.step_rad;
    if (stands) self.kept.pop_back();
  }
  if (!stands) self.T_world_step = middle;
  const RowSelection measured_rows = *self.sensor.measured_rows;
  for (int row = 0; row < measured.rows; ++row) {
    const int sensor_row = measured_rows.offset + row * measured_rows.stride;
    for (int column = 0; column < measured.columns; ++column) {
      const std::size_t pixel = measured.index(row, column);
      if (measured.range_m[pixel] <= 0.0F) continue;
      const int head = self.sensor.firing_column(sensor_row, column);
      const Pose& pose = T_world_sensor[T_world_sensor.size() > 1 ? head : 0];
      append(scan, (pose * measured.points_m[pixel].cast<double>() - self.origin_m).cast<float>(),
             self.projection.head_offset(sensor_row));
    }
  }
  while (scan.x_m.size() % 16 != 0) append(scan, Eigen::Vector3f::Constant(NAN), 0.0F);
  self.kept.push_back(std::move(scan));
  while (std::ssize(self.kept) > self.options.scans ||
         self.path_m - self.kept.front().path_m > self.options.path_m ||
         stamp_s - self.kept.front().stamp_s > self.options.time_s) {
    self.kept.pop_front();
  }
}

void ScanMemory::clear() { implementation_->kept.clear(); }

}  // namespace hqslam::nn
