#include "hqslam/core/projection.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "hqslam/core/error.h"
#include "scan/column_finder.h"
#include "scan/row_correlation.h"

namespace hqslam {

namespace {

/// The distance of a point from the origin, summed in the same order on every machine: Eigen's
/// norm() sums as the processor's vectors suggest.
float range_of(const Eigen::Vector3f& point_m) {
  const Eigen::Array3f squares = point_m.array().square();
  return std::sqrt(squares.x() + (squares.y() + squares.z()));
}

/// The beam nearest in elevation, or nothing if the direction is more than half a beam spacing
/// above the highest or below the lowest beam.
std::optional<int> nearest_row(double elevation_rad, const std::vector<double>& beams_rad) {
  const int rows = static_cast<int>(beams_rad.size());
  const auto below = std::ranges::lower_bound(beams_rad, elevation_rad,
                                              std::greater_equal<>());  // beams fall
  const auto above = static_cast<int>(below - beams_rad.begin());
  int row = above;
  if (above == rows ||
      (above > 0 && beams_rad[above - 1] - elevation_rad < elevation_rad - beams_rad[above])) {
    row = above - 1;
  }
  const int neighbour = row + 1 < rows ? row + 1 : row - 1;
  if (neighbour < 0) return row;
  const double half_spacing_rad = std::abs(beams_rad[row] - beams_rad[neighbour]) / 2.0;
  const bool beyond_edge = (row == 0 && elevation_rad > beams_rad[0] + half_spacing_rad) ||
                           (row == rows - 1 && elevation_rad < beams_rad[row] - half_spacing_rad);
  return beyond_edge ? std::nullopt : std::optional(row);
}

void require_matching_shapes(const Scan& scan, const SensorModel& sensor) {
  const std::size_t points = scan.points_m.size();
  if (!scan.row.empty() && scan.row.size() != points) {
    throw Error("scan has {} points but {} rows: expected one row per point or none", points,
                scan.row.size());
  }
  const auto require_as_many = [&](const std::vector<float>& values, const char* name) {
    if (values.empty() || values.size() == points) return;
    throw Error("scan has {} points but {} {}: expected one per point or none", points,
                values.size(), name);
  };
  require_as_many(scan.time_offset_s, "time offsets");
  require_as_many(scan.intensity, "intensities");
  for (const std::uint16_t row : scan.row) {
    if (row >= sensor.rows()) {
      throw Error(
          "scan has a point in row {} but sensor '{}' has rows 0 to {}: name the sensor that "
          "recorded the scan",
          row, sensor.name, sensor.rows() - 1);
    }
  }
}

/// The rows of a scan with fewer points are not judged.
constexpr std::size_t kFewestPointsToJudge = 1000;
/// Rows of the beams have less than -0.95 in the sensor's frame, those of a sensor on its side 0,
/// rings that count from the lowest beam more than 0.95.
constexpr double kMostRowCorrelation = -0.5;

/// Rows that do not fall would put the ground above the horizon: poses metres off, all "ok".
void require_highest_row_first(const Scan& scan, const SensorModel& sensor) {
  if (scan.row.size() < kFewestPointsToJudge) return;
  const double correlation = correlation_with_elevation(scan.row, scan.points_m);
  if (correlation == 0.0 || correlation < kMostRowCorrelation) return;  // 0: points of one row
  throw Error(
      "scan has rows that do not fall with the elevation of its points (correlation {:.2f}): "
      "expected row 0 for the highest beam, and points in the sensor's frame, z up; rings that "
      "count from the lowest beam give the row {} - ring",
      correlation, sensor.rows() - 1);
}

/// When every pixel is measured, relative to the middle of the scan: -period/2 .. +period/2. A head
/// at `first_column` begins a scan; the scan's stamp is its middle.
std::vector<float> time_offsets_s(const SensorModel& sensor, int first_column) {
  std::vector<float> of_head_s(sensor.columns);
  for (int i = 0; i < sensor.columns; ++i) {
    of_head_s[(first_column + i) % sensor.columns] =
        static_cast<float>(((i + 0.5) / sensor.columns - 0.5) * sensor.scan_period_s);
  }
  std::vector<float> result;
  result.reserve(of_head_s.size() * static_cast<std::size_t>(sensor.rows()));
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto first = of_head_s.begin() + sensor.firing_column(row, 0);
    result.insert(result.end(), first, of_head_s.end());
    result.insert(result.end(), of_head_s.begin(), first);
  }
  return result;
}

/// (cos, sin) of the azimuth of every pixel. Rows of the same residual azimuth have the same ones:
/// all rows where beams have no offsets.
struct HorizontalDirections {
  int columns = 0;
  std::vector<double> beam_azimuth_offset_rad;
  std::map<double, std::vector<Eigen::Vector2d>> of_residual;
};

/// Kept from scan to scan: to find them takes as long as all the rest.
const HorizontalDirections& horizontal_directions(const SensorModel& sensor) {
  thread_local HorizontalDirections last;
  if (last.columns == sensor.columns &&
      last.beam_azimuth_offset_rad == sensor.beam_azimuth_offset_rad) {
    return last;
  }
  last = {sensor.columns, sensor.beam_azimuth_offset_rad, {}};
  for (int row = 0; row < sensor.rows(); ++row) {
    std::vector<Eigen::Vector2d>& directions = last.of_residual[sensor.residual_azimuth_rad(row)];
    if (!directions.empty()) continue;
    for (int column = 0; column < sensor.columns; ++column) {
      const double azimuth_rad = sensor.azimuth_rad(row, column);
      directions.emplace_back(std::cos(azimuth_rad), std::sin(azimuth_rad));
    }
  }
  return last;
}

}  // namespace

ProjectedScan project(const Scan& scan, const SensorModel& sensor) {
  require_matching_shapes(scan, sensor);
  require_highest_row_first(scan, sensor);
  ProjectedScan result;
  result.cloud = OrganizedCloud(sensor.rows(), sensor.columns);
  if (!scan.time_offset_s.empty()) {
    result.cloud.time_offset_s.assign(result.cloud.range_m.size(), 0.0F);
  }
  if (!scan.intensity.empty()) result.cloud.intensity.assign(result.cloud.range_m.size(), 0.0F);
  const ColumnFinder columns(sensor);
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    const Eigen::Vector3f& point_m = scan.points_m[i];
    const float range_m = range_of(point_m);
    if (!(range_m >= sensor.min_range_m && range_m <= sensor.max_range_m) || range_m <= 0.0F) {
      ++result.counts.out_of_range;
      continue;
    }
    const std::optional<int> row =
        scan.row.empty() ? nearest_row(std::asin(point_m.z() / range_m), sensor.beam_elevation_rad)
                         : std::optional<int>(scan.row[i]);
    if (!row) {
      ++result.counts.outside_rows;
      continue;
    }
    const std::size_t pixel = result.cloud.index(*row, columns.column(*row, point_m));
    float& nearest_m = result.cloud.range_m[pixel];
    if (nearest_m > 0.0F) ++result.counts.hidden_by_nearer;
    if (nearest_m > 0.0F && nearest_m <= range_m) continue;
    nearest_m = range_m;
    result.cloud.points_m[pixel] = point_m;
    if (!scan.time_offset_s.empty()) result.cloud.time_offset_s[pixel] = scan.time_offset_s[i];
    if (!scan.intensity.empty()) result.cloud.intensity[pixel] = scan.intensity[i];
  }
  for (const float range_m : result.cloud.range_m) result.counts.kept += range_m > 0.0F ? 1 : 0;
  return result;
}

Scan returns_of(const OrganizedCloud& cloud) {
  Scan scan;
  const auto keep = [](const auto& values, std::size_t pixel, auto& result) {
    if (!values.empty()) result.push_back(values[pixel]);
  };
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    if (!(cloud.range_m[pixel] > 0.0F)) continue;
    scan.points_m.push_back(cloud.points_m[pixel]);
    scan.row.push_back(static_cast<std::uint16_t>(pixel / static_cast<std::size_t>(cloud.columns)));
    keep(cloud.time_offset_s, pixel, scan.time_offset_s);
    keep(cloud.confidence, pixel, scan.confidence);
    keep(cloud.intensity, pixel, scan.intensity);
  }
  return scan;
}

OrganizedCloud unproject(const RangeImage& image, const SensorModel& sensor,
                         CaptureTime capture_time, int first_column) {
  if (image.rows != sensor.rows() || image.columns != sensor.columns) {
    throw Error(
        "image of {}x{} pixels does not fit sensor '{}' of {}x{}: name the sensor that recorded it",
        image.rows, image.columns, sensor.name, sensor.rows(), sensor.columns);
  }
  OrganizedCloud cloud(image.rows, image.columns);
  if (capture_time == CaptureTime::kRolling) {
    cloud.time_offset_s = time_offsets_s(sensor, first_column);
  }
  const HorizontalDirections& directions = horizontal_directions(sensor);
  for (int row = 0; row < image.rows; ++row) {
    const double cos_elevation = std::cos(sensor.beam_elevation_rad[row]);
    const double sin_elevation = std::sin(sensor.beam_elevation_rad[row]);
    const auto& direction = directions.of_residual.at(sensor.residual_azimuth_rad(row));
    for (int column = 0; column < image.columns; ++column) {
      const std::size_t pixel = image.index(row, column);
      const double range_m = image.range_m[pixel];
      if (!(range_m > 0.0) || !std::isfinite(range_m)) continue;
      const Eigen::Vector2d horizontal = cos_elevation * direction[column];
      cloud.range_m[pixel] = image.range_m[pixel];
      cloud.points_m[pixel] =
          (range_m * Eigen::Vector3d(horizontal.x(), horizontal.y(), sin_elevation)).cast<float>();
    }
  }
  return cloud;
}

int first_column(const OrganizedCloud& cloud, const SensorModel& sensor) {
  if (cloud.time_offset_s.empty()) return 0;
  constexpr int kEvery = 8;  // column; all give the same answer
  const double column_rad = 2.0 * std::numbers::pi / sensor.columns;
  std::complex<double> sum;  // a mean round the turn
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; column += kEvery) {
      const std::size_t pixel = cloud.index(row, column);
      if (cloud.range_m[pixel] <= 0.0F) continue;
      const double turned = cloud.time_offset_s[pixel] / sensor.scan_period_s + 0.5;
      const double first = sensor.firing_column(row, column) + 0.5 - turned * sensor.columns;
      sum += std::polar(1.0, column_rad * first);
    }
  }
  const auto first = static_cast<int>(std::lround(std::arg(sum) / column_rad));
  return first < 0 ? first + sensor.columns : first;
}

}  // namespace hqslam
