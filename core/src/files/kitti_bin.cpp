#include "hqslam/core/kitti_bin.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"

namespace hqslam {

namespace {

constexpr std::size_t kBytesPerPoint = 4 * sizeof(float);
constexpr std::size_t kMaxBinFileBytes = 64U << 20U;  // 4 million points, 30 times a scan
/// No LiDAR measures farther: bytes that give a larger coordinate are no coordinates.
constexpr float kMaxCoordinate_m = 10'000.0F;
constexpr double kMaxImplausibleShare = 0.1;

bool is_text(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 4096);
  return std::ranges::all_of(
      start, [](unsigned char c) { return std::isprint(c) != 0 || std::isspace(c) != 0; });
}

/// Whether every fifth number is a small whole one, and not all are 0: nuScenes' x y z intensity
/// ring.
bool has_rings(const std::string& bytes) {
  constexpr std::size_t kBytes = 5 * sizeof(float);
  constexpr std::size_t kFewestPoints = 100;
  constexpr float kMostRings = 256.0F;
  if (bytes.size() % kBytes != 0 || bytes.size() < kFewestPoints * kBytes) return false;
  float largest = 0.0F;
  for (std::size_t at = kBytes - sizeof(float); at < bytes.size(); at += kBytes) {
    float ring = 0.0F;
    std::memcpy(&ring, bytes.data() + at, sizeof(float));
    if (!(ring >= 0.0F && ring < kMostRings) || ring != std::floor(ring)) return false;
    largest = std::max(largest, ring);
  }
  return largest > 0.0F;
}

void require_points(const std::string& bytes, const std::string& path) {
  if (bytes.empty()) {
    throw Error("{}: expected a KITTI scan, found an empty file; copy it again", path);
  }
  if (is_text(bytes)) {
    throw Error(
        "{}: expected a KITTI scan (binary float32 x y z intensity), found text; give the original "
        ".bin file",
        path);
  }
  if (has_rings(bytes)) {
    throw Error(
        "{}: expected a KITTI scan of 4 numbers a point (16 bytes: float32 x y z intensity), found "
        "5 numbers a point (20 bytes), the last of them a ring, as nuScenes has; save it as .pcd "
        "with a field ring",
        path);
  }
  if (bytes.size() % kBytesPerPoint != 0) {
    throw Error(
        "{}: expected a KITTI scan of 16 bytes per point (float32 x y z intensity), found {} "
        "bytes, {} too many; the file is truncated or of another kind",
        path, bytes.size(), bytes.size() % kBytesPerPoint);
  }
}

}  // namespace

Scan read_kitti_bin(const std::string& path) {
  const std::string bytes = whole_file(path, "a KITTI .bin file", kMaxBinFileBytes);
  require_points(bytes, path);
  const std::size_t points = bytes.size() / kBytesPerPoint;
  std::size_t implausible = 0;
  Scan scan;
  scan.points_m.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    std::array<float, 4> numbers{};
    std::memcpy(numbers.data(), bytes.data() + i * kBytesPerPoint, sizeof(numbers));
    const Eigen::Vector3f point_m(numbers[0], numbers[1], numbers[2]);
    if (!point_m.allFinite() || point_m.isZero(0.0F)) {
      ++scan.invalid_points;
      continue;
    }
    if (point_m.cwiseAbs().maxCoeff() > kMaxCoordinate_m) ++implausible;
    scan.points_m.push_back(point_m);
    scan.intensity.push_back(numbers[3]);
  }
  if (static_cast<double>(implausible) > kMaxImplausibleShare * static_cast<double>(points)) {
    throw Error(
        "{}: expected coordinates in metres, found {} of {} points beyond {} m; give float32 x y z "
        "intensity in metres",
        path, implausible, points, kMaxCoordinate_m);
  }
  return scan;
}

void write_kitti_bin(const Scan& scan, const std::string& path) {
  std::string bytes(scan.points_m.size() * kBytesPerPoint, '\0');
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    char* const point = bytes.data() + i * kBytesPerPoint;
    std::memcpy(point, scan.points_m[i].data(), 3 * sizeof(float));
    if (scan.intensity.empty() || !std::isfinite(scan.intensity[i])) continue;
    std::memcpy(point + 3 * sizeof(float), &scan.intensity[i], sizeof(float));
  }
  write_whole_file(path, bytes);
}

}  // namespace hqslam
