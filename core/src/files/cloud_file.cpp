#include "hqslam/core/cloud_file.h"

#include <fmt/format.h>

#include <fstream>
#include <string_view>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/point_columns.h"

namespace hqslam {

namespace {

std::string pcd_header(const std::vector<PointColumn>& columns, std::size_t points,
                       const std::string& note) {
  std::string names, sizes, types, counts;
  for (const PointColumn& column : columns) {
    names += fmt::format(" {}", column.name);
    sizes += fmt::format(" {}", column.stored.bytes);
    types += fmt::format(" {}", column.stored.type);
    counts += " 1";
  }
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n{}VERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\n"
      "COUNT{}\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
      note.empty() ? "" : "# " + note + "\n", names, sizes, types, counts, points, points);
}

const char* ply_type(StoredNumber stored) {
  if (stored.type == 'F') return stored.bytes == 4 ? "float" : "double";
  return stored.bytes == 2 ? "ushort" : "uint";
}

std::string ply_header(const std::vector<PointColumn>& columns, std::size_t points,
                       const std::string& note) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (!note.empty()) header += "comment " + note + "\n";
  header += fmt::format("comment metres\nelement vertex {}\n", points);
  for (const PointColumn& column : columns) {
    header += fmt::format("property {} {}\n", ply_type(column.stored), column.name);
  }
  return header + "end_header\n";
}

void append_point(const std::vector<PointColumn>& columns, std::size_t i, std::string& bytes) {
  for (const PointColumn& column : columns) {
    bytes.append(static_cast<const char*>(column.first) + i * column.step_bytes,
                 column.stored.bytes);
  }
}

}  // namespace

void write_points(const std::vector<PointColumn>& columns, std::size_t points,
                  const std::string& path, const std::string& note) {
  constexpr std::size_t kBuffer = 1U << 20U;
  std::string_view name = path;
  if (name.ends_with(".part")) name.remove_suffix(5);  // of a file that gets its name at the end
  std::string bytes;
  if (name.ends_with(".pcd")) {
    bytes = pcd_header(columns, points, note);
  } else if (name.ends_with(".ply")) {
    bytes = ply_header(columns, points, note);
  } else {
    throw Error("{}: expected a name that ends with .pcd or .ply; give another", path);
  }
  std::ofstream stream(path, std::ios::binary);
  for (std::size_t i = 0; i < points; ++i) {
    append_point(columns, i, bytes);
    if (bytes.size() < kBuffer) continue;
    stream.write(bytes.data(), std::ssize(bytes));
    bytes.clear();
  }
  stream.write(bytes.data(), std::ssize(bytes));
  stream.close();
  if (!stream) {
    throw Error(
        "{}: cannot be written; check that the folder exists, is writable and has free space",
        path);
  }
}

void write_cloud(const Scan& scan, const std::string& path) {
  const std::size_t points = scan.points_m.size();
  std::vector<double> stamp_s;
  for (const float offset_s : scan.time_offset_s)
    stamp_s.push_back(scan.stamp_s + double{offset_s});
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  const auto* const xyz = reinterpret_cast<const float*>(scan.points_m.data());
  std::vector<PointColumn> columns = {{"x", {'F', 4}, xyz, sizeof(Eigen::Vector3f)},
                                      {"y", {'F', 4}, xyz + 1, sizeof(Eigen::Vector3f)},
                                      {"z", {'F', 4}, xyz + 2, sizeof(Eigen::Vector3f)}};
  const auto add = [&](const char* name, char type, const auto& values) {
    if (values.empty()) return;
    if (values.size() != points) {
      throw Error("{}: {} of '{}' for {} points, expected as many", path, values.size(), name,
                  points);
    }
    columns.push_back({name, {type, sizeof(values[0])}, values.data(), sizeof(values[0])});
  };
  add("intensity", 'F', scan.intensity);
  add("ring", 'U', scan.row);
  add("timestamp", 'F', stamp_s);
  add("confidence", 'F', scan.confidence);
  write_points(columns, points, path);
}

}  // namespace hqslam
