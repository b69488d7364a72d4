#include "hqslam/core/pcd.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "pcd_points.h"
#include "point_files.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31U;  // maps are larger than scans

}  // namespace

RawPoints read_pcd_points(const std::string& path) {
  const std::string file = whole_file(path, "a .pcd file", kMaxFileBytes);
  const PcdHeader header = parse_pcd_header(file, path);
  PcdPoints data(file, header, path);
  const PointFields fields = point_fields(header.fields, path);
  for (const PointField* field : {fields.x, fields.y, fields.z, fields.ring, fields.time}) {
    if (field == nullptr || field->count > 0) continue;
    throw Error(
        fmt::format("{}: field '{}': expected one number per point, found none; give a "
                    ".pcd file with COUNT 1 for it",
                    path, field->name));
  }
  RawPoints points(fields, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    data.go_to(i);
    points.add(fields, [&](const PointField& field) { return data.value(field); });
  }
  return points;
}

Scan read_pcd(const std::string& path) { return scan_of(read_pcd_points(path), nullptr, path); }

Scan read_pcd(const std::string& path, const SensorModel& sensor) {
  return scan_of(read_pcd_points(path), &sensor, path);
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
