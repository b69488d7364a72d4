#include "hqslam/core/pcd.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "pcd_columns.h"
#include "pcd_header.h"
#include "raw_points.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31U;  // maps are larger than scans

/// The columns of a file that matter here.
struct PointColumns {
  PcdColumn x, y, z;
  std::optional<PcdColumn> time;
  bool whole_times = false;
  std::string time_name;
  std::optional<PcdColumn> ring;
  std::string ring_name;
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
                    path, excerpt(found, 200)));
  }
  return columns.column(*field);
}

PointColumns point_columns(const PcdHeader& header, const PcdColumns& columns,
                           const std::string& path) {
  PointColumns result;
  result.x = coordinate(header, columns, "x", path);
  result.y = coordinate(header, columns, "y", path);
  result.z = coordinate(header, columns, "z", path);
  for (const char* name : kTimeNames) {
    const PcdField* const field = field_named(header, name);
    if (field == nullptr) continue;
    result.time = columns.column(*field);
    result.whole_times = field->type != 'F';
    result.time_name = name;
    break;
  }
  for (const char* name : kRingNames) {
    const PcdField* const field = field_named(header, name);
    if (field == nullptr) continue;
    result.ring = columns.column(*field);
    result.ring_name = name;
    break;
  }
  return result;
}

RawPoints raw_points(const PointColumns& columns, PcdColumns& data, std::size_t points) {
  RawPoints raw;
  raw.ring_name = columns.ring_name;
  raw.time.name = columns.time_name;
  raw.time.whole_numbers = columns.whole_times;
  raw.scan.points_m.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    data.read_point(i);
    if (!raw.add(columns.x.at(i), columns.y.at(i), columns.z.at(i))) continue;
    if (columns.time) raw.time.values.push_back(columns.time->at(i));
    if (columns.ring) raw.ring.push_back(columns.ring->at(i));
  }
  return raw;
}

Scan scan_from(const std::string& path, const SensorModel* sensor) {
  const std::string file = whole_file(path, "a .pcd file", kMaxFileBytes);
  const PcdHeader header = parse_pcd_header(file, path);
  PcdColumns data(file, header, path);
  const PointColumns columns = point_columns(header, data, path);
  return scan_of(raw_points(columns, data, header.points), sensor, path);
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
