#include "hqslam/core/point_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam {

namespace {

/// No LiDAR takes so long for one scan.
constexpr double kMaxScanDuration_s = 1.0;

/// Beyond this the stamp of a message and the clock of its points' times are not one clock.
constexpr double kMostClocksApart_s = 2.0;

/// "timeStamp" and "time_stamp" are one name.
std::string plain(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return result;
}

/// The first of the names that is there; nullptr: none is.
const PointField* field_of(const std::vector<PointField>& fields,
                           std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    for (const PointField& field : fields) {
      if (plain(field.name) == name) return &field;
    }
  }
  return nullptr;
}

}  // namespace

PointFields point_fields(const std::vector<PointField>& fields, const std::string& source,
                         const char* kind) {
  const PointFields found = {
      field_of(fields, {"x"}), field_of(fields, {"y"}), field_of(fields, {"z"}),
      field_of(fields, {"ring", "channel", "line", "laserid", "ringid", "beam"}),
      field_of(fields,
               {"t", "time", "timestamp", "offsettime", "timeoffset", "toffset", "relativetime"})};
  if (found.x == nullptr || found.y == nullptr || found.z == nullptr) {
    std::string names;
    for (const PointField& field : fields) names += (names.empty() ? "" : " ") + field.name;
    throw Error(fmt::format("{}: expected {} x y z, found {}; give a point cloud with coordinates",
                            source, kind, excerpt(names, 200)));
  }
  return found;
}

RawPoints::RawPoints(const PointFields& fields, std::size_t points) {
  if (fields.ring != nullptr) ring_name = fields.ring->name;
  if (fields.time != nullptr) {
    time.name = fields.time->name;
    time.whole_numbers = fields.time->stored.type != 'F';
  }
  scan.points_m.reserve(points);
}

bool RawPoints::add(double x_m, double y_m, double z_m) {
  const Eigen::Vector3f point_m(static_cast<float>(x_m), static_cast<float>(y_m),
                                static_cast<float>(z_m));
  if (!point_m.allFinite() || point_m.isZero(0.0F)) {
    ++scan.invalid_points;
    return false;
  }
  scan.points_m.push_back(point_m);
  return true;
}

Scan scan_of(RawPoints points, const SensorModel* sensor, const std::string& source,
             std::optional<double> stamp_s) {
  Scan& scan = points.scan;
  const double period_s = sensor != nullptr ? sensor->scan_period_s : kMaxScanDuration_s;
  scan.stamp_s = stamp_s.value_or(0.0);
  if (auto times = point_times(points.time, period_s, source)) {
    scan.time_offset_s = std::move(times->offset_s);
    const bool same_clock = !stamp_s || std::abs(times->middle_s - *stamp_s) < kMostClocksApart_s;
    if (times->absolute && same_clock) {
      scan.stamp_s = times->middle_s;
    } else if (times->absolute) {
      scan.stamp_s -= static_cast<double>(
          *std::min_element(scan.time_offset_s.begin(), scan.time_offset_s.end()));
    } else if (stamp_s) {
      scan.stamp_s += times->middle_s;
    }
  }
  if (sensor != nullptr && !points.ring.empty()) {
    scan.row = rows_from_rings(points.ring, scan, *sensor, source, points.ring_name);
  }
  return std::move(scan);
}

}  // namespace hqslam
