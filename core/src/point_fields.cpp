#include "hqslam/core/point_fields.h"

#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam {

namespace {

/// No LiDAR takes so long for one scan.
constexpr double kMaxScanDuration_s = 1.0;

/// The first of the names that is there; nullptr: none is.
const PointField* field_of(const std::vector<PointField>& fields,
                           std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    for (const PointField& field : fields) {
      if (field.name == name) return &field;
    }
  }
  return nullptr;
}

}  // namespace

PointFields point_fields(const std::vector<PointField>& fields, const std::string& source,
                         const char* kind) {
  const PointFields found = {
      field_of(fields, {"x"}), field_of(fields, {"y"}), field_of(fields, {"z"}),
      field_of(fields, {"ring", "channel"}),
      field_of(fields, {"t", "time", "timestamp", "time_stamp", "timeStamp", "offset_time"})};
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

Scan scan_of(RawPoints points, const SensorModel* sensor, const std::string& path) {
  const double period_s = sensor != nullptr ? sensor->scan_period_s : kMaxScanDuration_s;
  if (auto times = point_times(points.time, period_s, path)) {
    points.scan.time_offset_s = std::move(times->offset_s);
    if (times->absolute) points.scan.stamp_s = times->middle_s;
  }
  if (sensor != nullptr && !points.ring.empty()) {
    points.scan.row = rows_from_rings(points.ring, points.scan, *sensor, path, points.ring_name);
  }
  return std::move(points.scan);
}

}  // namespace hqslam
