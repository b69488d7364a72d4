#include "hqslam/core/pcd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "hqslam/core/error.h"
#include "pcd_columns.h"
#include "pcd_header.h"
#include "whole_file.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31U;  // maps are larger than scans
/// No LiDAR takes so long for one scan: the times are in another unit.
constexpr double kMaxScanDuration_s = 1.0;
/// Rings in the order of the beams correlate with the elevation by more than 0.95; in the order of
/// firing by less than 0.6.
constexpr double kMinRingCorrelation = 0.8;

/// The columns of a file that matter here.
struct PointColumns {
  PcdColumn x, y, z;
  std::optional<PcdColumn> time;
  double time_unit_s = 1.0;
  std::string time_name;
  std::optional<PcdColumn> ring;
};

const PcdField* field_named(const PcdHeader& header, std::string_view name) {
  for (const PcdField& field : header.fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

PcdColumn coordinate(const PcdHeader& header, const PcdColumns& columns, std::string_view name,
                     const std::string& path) {
  const PcdField* const field = field_named(header, name);
  if (field == nullptr) {
    std::string found;
    for (const PcdField& other : header.fields) found += (found.empty() ? "" : " ") + other.name;
    throw Error(
        fmt::format("{}: expected fields x y z, found {}; give a point cloud with "
                    "coordinates",
                    path, found));
  }
  return columns.column(*field);
}

PointColumns point_columns(const PcdHeader& header, const PcdColumns& columns,
                           const std::string& path) {
  PointColumns result;
  result.x = coordinate(header, columns, "x", path);
  result.y = coordinate(header, columns, "y", path);
  result.z = coordinate(header, columns, "z", path);
  for (const char* name : {"t", "time", "timestamp"}) {
    const PcdField* const field = field_named(header, name);
    if (field == nullptr) continue;
    result.time = columns.column(*field);
    result.time_unit_s = field->type == 'F' ? 1.0 : 1e-9;
    result.time_name = name;
    break;
  }
  if (const PcdField* const field = field_named(header, "ring")) {
    result.ring = columns.column(*field);
  }
  return result;
}

/// A scan with the rings and times of its points as the file has them.
struct RawScan {
  Scan scan;
  std::vector<double> time;
  std::vector<double> ring;
};

RawScan raw_scan(const PointColumns& columns, std::size_t points) {
  RawScan raw;
  raw.scan.points_m.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3f point_m(static_cast<float>(columns.x.at(i)),
                                  static_cast<float>(columns.y.at(i)),
                                  static_cast<float>(columns.z.at(i)));
    if (!point_m.allFinite() || point_m.isZero(0.0F)) {
      ++raw.scan.invalid_points;
      continue;
    }
    raw.scan.points_m.push_back(point_m);
    if (columns.time) raw.time.push_back(columns.time->at(i));
    if (columns.ring) raw.ring.push_back(columns.ring->at(i));
  }
  return raw;
}

/// Offsets from the middle of the times; none if all times are equal (a driver that fills in 0).
std::vector<float> time_offsets_s(const std::vector<double>& time, const PointColumns& columns,
                                  const std::string& path) {
  if (time.empty()) return {};
  const auto [first, last] = std::minmax_element(time.begin(), time.end());
  const double duration_s = (*last - *first) * columns.time_unit_s;
  const bool finite =
      std::all_of(time.begin(), time.end(), [](double t) { return std::isfinite(t); });
  if (!finite || duration_s > kMaxScanDuration_s) {
    throw Error(fmt::format(
        "{}: field '{}': expected times of one scan in {}, found {}; give the "
        "times in that unit or leave the field out",
        path, columns.time_name, columns.time_unit_s == 1.0 ? "seconds" : "nanoseconds",
        finite ? fmt::format("a scan of {:.6g} s", duration_s) : "a time that is not finite"));
  }
  if (duration_s == 0.0) return {};
  const double middle = *first + (*last - *first) / 2.0;
  std::vector<float> offsets_s;
  offsets_s.reserve(time.size());
  for (const double t : time) {
    offsets_s.push_back(static_cast<float>((t - middle) * columns.time_unit_s));
  }
  return offsets_s;
}

/// Pearson's correlation of ring number and elevation; 0 where one of them does not vary.
double correlation_with_elevation(const std::vector<double>& ring, const Scan& scan) {
  double sum_r = 0.0, sum_e = 0.0, sum_rr = 0.0, sum_ee = 0.0, sum_re = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double elevation_rad =
        std::atan2(scan.points_m[i].z(), scan.points_m[i].head<2>().norm());
    sum_r += ring[i];
    sum_e += elevation_rad;
    sum_rr += ring[i] * ring[i];
    sum_ee += elevation_rad * elevation_rad;
    sum_re += ring[i] * elevation_rad;
  }
  const double n = static_cast<double>(ring.size());
  const double variance_r = sum_rr - sum_r * sum_r / n;
  const double variance_e = sum_ee - sum_e * sum_e / n;
  if (!(variance_r > 1e-9 * n) || !(variance_e > 1e-12 * n)) return 0.0;
  return (sum_re - sum_r * sum_e / n) / std::sqrt(variance_r * variance_e);
}

std::vector<std::uint16_t> rows_from_rings(const RawScan& raw, const SensorModel& sensor,
                                           const std::string& path) {
  const double last_ring = sensor.rows() - 1;
  for (const double ring : raw.ring) {
    if (!(ring >= 0.0 && ring <= last_ring) || ring != std::floor(ring)) {
      throw Error(
          fmt::format("{}: field 'ring': expected 0 to {} for sensor '{}', found {}; name "
                      "the sensor that recorded the scan",
                      path, last_ring, sensor.name, ring));
    }
  }
  const double correlation = correlation_with_elevation(raw.ring, raw.scan);
  if (std::abs(correlation) < kMinRingCorrelation) return {};
  std::vector<std::uint16_t> rows;
  rows.reserve(raw.ring.size());
  for (const double ring : raw.ring) {
    rows.push_back(static_cast<std::uint16_t>(correlation < 0.0 ? ring : last_ring - ring));
  }
  return rows;
}

Scan scan_from(const std::string& path, const SensorModel* sensor) {
  const std::string file = whole_file(path, "a .pcd file", kMaxFileBytes);
  const PcdHeader header = parse_pcd_header(file, path);
  const PcdColumns columns(file, header, path);
  const PointColumns used = point_columns(header, columns, path);
  RawScan raw = raw_scan(used, header.points);
  raw.scan.time_offset_s = time_offsets_s(raw.time, used, path);
  if (sensor != nullptr) raw.scan.row = rows_from_rings(raw, *sensor, path);
  return std::move(raw.scan);
}

}  // namespace

Scan read_pcd(const std::string& path) { return scan_from(path, nullptr); }

Scan read_pcd(const std::string& path, const SensorModel& sensor) {
  return scan_from(path, &sensor);
}

void write_pcd(const std::vector<Eigen::Vector3f>& points_m, const std::string& path,
               const std::vector<float>& confidence) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  const bool sure = !confidence.empty();
  if (sure && confidence.size() != points_m.size()) {
    throw Error(fmt::format("{}: {} confidences for {} points, expected as many", path,
                            confidence.size(), points_m.size()));
  }
  std::string bytes = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z{1}\nSIZE 4 4 4{2}\n"
      "TYPE F F F{3}\nCOUNT 1 1 1{4}\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\n"
      "DATA binary\n",
      points_m.size(), sure ? " confidence" : "", sure ? " 4" : "", sure ? " F" : "",
      sure ? " 1" : "");
  const std::size_t point_bytes = sizeof(Eigen::Vector3f) + (sure ? sizeof(float) : 0);
  std::size_t next = bytes.size();
  bytes.resize(next + points_m.size() * point_bytes);
  for (std::size_t i = 0; i < points_m.size(); ++i, next += point_bytes) {
    std::memcpy(bytes.data() + next, points_m[i].data(), sizeof(Eigen::Vector3f));
    if (sure) {
      std::memcpy(bytes.data() + next + sizeof(Eigen::Vector3f), &confidence[i], sizeof(float));
    }
  }
  write_whole_file(path, bytes);
}

}  // namespace hqslam
