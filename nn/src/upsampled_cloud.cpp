#include "hqslam/nn/upsampled_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "hqslam/core/projection.h"

namespace hqslam::nn {
namespace {

/// Deviations below this are rounding of the points' coordinates.
constexpr float kRounding_rad = 1e-6F;

/// The difference between a measured point and the sensor model of its pixel.
struct Deviation {
  bool has_return = false;
  float elevation_rad = 0.0F;
  float time_s = 0.0F;
};

/// beam: (cos, sin) of the elevation of the model's beam.
float elevation_deviation_rad(const Eigen::Vector3f& point_m, double beam_rad,
                              const Eigen::Vector2f& beam) {
  const float horizontal_m = std::hypot(point_m.x(), point_m.y());
  const float off_m = std::abs(beam.x() * point_m.z() - beam.y() * horizontal_m);
  const float at_least_m = std::max(std::abs(point_m.z()), horizontal_m);
  if (off_m < 0.5F * kRounding_rad * at_least_m) return 0.0F;  // without atan2
  const double elevation_rad = std::atan2(point_m.z(), horizontal_m);
  const auto off_rad = static_cast<float>(elevation_rad - beam_rad);
  return std::abs(off_rad) < kRounding_rad ? 0.0F : off_rad;
}

/// The deviations of all pixels of the measured rows. model: all rows by the sensor model.
std::vector<Deviation> deviations_of(const OrganizedCloud& measured, RowSelection measured_rows,
                                     const SensorModel& sensor, const OrganizedCloud& model) {
  std::vector<Deviation> deviations(measured.range_m.size());
#pragma omp parallel for schedule(static)
  for (int i = 0; i < measured.rows; ++i) {
    const int row = measured_rows.offset + i * measured_rows.stride;
    const double beam_rad = sensor.beam_elevation_rad[row];
    const Eigen::Vector2f beam =
        Eigen::Vector2d(std::cos(beam_rad), std::sin(beam_rad)).cast<float>();
    for (int column = 0; column < measured.columns; ++column) {
      const std::size_t pixel = measured.index(i, column);
      if (measured.range_m[pixel] <= 0.0F) continue;
      Deviation& deviation = deviations[pixel];
      deviation.has_return = true;
      deviation.elevation_rad = elevation_deviation_rad(measured.points_m[pixel], beam_rad, beam);
      if (measured.time_offset_s.empty()) continue;
      deviation.time_s =
          measured.time_offset_s[pixel] - model.time_offset_s[model.index(row, column)];
    }
  }
  return deviations;
}

/// The deviation a fraction t down from `above` to `below`.
Deviation between(const Deviation& above, const Deviation& below, float t) {
  if (!above.has_return || !below.has_return) {
    return above.has_return ? above : below;
  }
  return {true, (1.0F - t) * above.elevation_rad + t * below.elevation_rad,
          t < 0.5F ? above.time_s : below.time_s};
}

/// The intensity of a point of range_m, a fraction t down from measured pixel `above` to `below`;
/// nothing: there is no such pixel.
float intensity_between(const OrganizedCloud& measured, std::optional<std::size_t> above,
                        std::optional<std::size_t> below, float t, float range_m) {
  constexpr float kNear = 0.2F;
  const auto off_m = [&](std::optional<std::size_t> pixel) {
    return pixel && measured.range_m[*pixel] > 0.0F ? std::abs(measured.range_m[*pixel] - range_m)
                                                    : std::numeric_limits<float>::infinity();
  };
  const float above_off_m = off_m(above);
  const float below_off_m = off_m(below);
  if (std::max(above_off_m, below_off_m) <= kNear * range_m) {
    return (1.0F - t) * measured.intensity[*above] + t * measured.intensity[*below];
  }
  if (std::isinf(std::min(above_off_m, below_off_m))) return std::nanf("");
  return measured.intensity[above_off_m <= below_off_m ? *above : *below];
}

/// Turns a point up by an angle about the horizontal axis across its line of sight.
Eigen::Vector3f turned_up(const Eigen::Vector3f& point_m, float angle_rad) {
  const float horizontal_m = std::hypot(point_m.x(), point_m.y());
  const float cosine = std::cos(angle_rad);
  const float sine = std::sin(angle_rad);
  const float scale = cosine - point_m.z() / horizontal_m * sine;
  return {scale * point_m.x(), scale * point_m.y(), cosine * point_m.z() + sine * horizontal_m};
}

/// The rows between measured rows `above` and `below` (-1 or the number of rows: none there).
void correct_row(OrganizedCloud& cloud, int row, int above, int below, float t,
                 const OrganizedCloud& measured, const std::vector<Deviation>& deviations,
                 const SensorModel& sensor) {
  for (int column = 0; column < cloud.columns; ++column) {
    const auto pixel_in = [&](int measured_row) {
      return measured_row < 0 || measured_row >= measured.rows
                 ? std::nullopt
                 : std::optional(measured.index(measured_row, column));
    };
    const auto deviation_of = [&](std::optional<std::size_t> at) {
      return at ? deviations[*at] : Deviation();
    };
    const auto pixel_above = pixel_in(above);
    const auto pixel_below = pixel_in(below);
    const Deviation deviation = between(deviation_of(pixel_above), deviation_of(pixel_below), t);
    const std::size_t pixel = cloud.index(row, column);
    if (!measured.intensity.empty() && cloud.range_m[pixel] > 0.0F) {
      cloud.intensity[pixel] =
          intensity_between(measured, pixel_above, pixel_below, t, cloud.range_m[pixel]);
    }
    if (deviation.elevation_rad != 0.0F && cloud.range_m[pixel] > 0.0F) {
      cloud.points_m[pixel] = turned_up(cloud.points_m[pixel], deviation.elevation_rad);
    }
    if (deviation.time_s != 0.0F) {  // what is off by a whole revolution comes back into the scan
      cloud.time_offset_s[pixel] = static_cast<float>(
          std::remainder(cloud.time_offset_s[pixel] + deviation.time_s, sensor.scan_period_s));
    }
  }
}

void copy_row(const OrganizedCloud& measured, int from, OrganizedCloud& cloud, int to) {
  const std::size_t source = measured.index(from, 0);
  const std::size_t target = cloud.index(to, 0);
  const auto copy = [&](const auto& values, auto& result) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(source), measured.columns,
                result.begin() + static_cast<std::ptrdiff_t>(target));
  };
  copy(measured.points_m, cloud.points_m);
  copy(measured.range_m, cloud.range_m);
  if (!measured.time_offset_s.empty()) {
    copy(measured.time_offset_s, cloud.time_offset_s);
  }
  if (!measured.intensity.empty()) copy(measured.intensity, cloud.intensity);
  if (cloud.confidence.empty()) return;
  for (int column = 0; column < measured.columns; ++column) {
    cloud.confidence[target + column] = measured.range_m[source + column] > 0.0F ? 1.0F : 0.0F;
  }
}

}  // namespace

OrganizedCloud upsampled_cloud(const UpsampledImage& upsampled, const OrganizedCloud& measured,
                               RowSelection measured_rows, const SensorModel& sensor) {
  OrganizedCloud cloud = unproject(
      upsampled.image, sensor,
      measured.time_offset_s.empty() ? CaptureTime::kMotionCorrected : CaptureTime::kRolling,
      first_column(measured, select_rows(sensor, measured_rows)));
  cloud.confidence = upsampled.confidence;
  if (!measured.intensity.empty()) cloud.intensity.assign(cloud.range_m.size(), 0.0F);
  const std::vector<Deviation> deviations = deviations_of(measured, measured_rows, sensor, cloud);
#pragma omp parallel for schedule(static)
  for (int row = 0; row < cloud.rows; ++row) {
    const int steps = row - measured_rows.offset;
    const int rest = ((steps % measured_rows.stride) + measured_rows.stride) % measured_rows.stride;
    const int above = (steps - rest) / measured_rows.stride;
    if (rest == 0 && above >= 0) {
      copy_row(measured, above, cloud, row);
    } else {
      const float t = static_cast<float>(rest) / static_cast<float>(measured_rows.stride);
      correct_row(cloud, row, above, above + 1, t, measured, deviations, sensor);
    }
  }
  return cloud;
}

OrganizedCloud upsampled_cloud(Upsampler& upsampler, const OrganizedCloud& measured,
                               const RecalledImage& recalled) {
  return upsampled_cloud(upsampler.run(range_image(measured), recalled), measured,
                         upsampler.measured_rows(), upsampler.sensor());
}

}  // namespace hqslam::nn
