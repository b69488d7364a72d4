#include "hqslam/slam/scan_context.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hqslam::slam {

namespace {

constexpr double kSector_rad = 2.0 * std::numbers::pi / ScanContext::kSectors;

/// Origin of the heights, so that the ground below a car has a height of about zero.
constexpr float kLowest_m = -2.0F;

constexpr float kLane_m = 4.0F;  // simulated streets alone

int wrapped(int sector) {
  return (sector % ScanContext::kSectors + ScanContext::kSectors) % ScanContext::kSectors;
}

double distance_at(const ScanContext& first, const ScanContext& other, int shift) {
  float similarity = 0.0F;
  int compared = 0;
  for (int sector = 0; sector < ScanContext::kSectors; ++sector) {
    const int turned = wrapped(sector + shift);
    if (!first.has_returns[turned] && !other.has_returns[sector]) continue;
    similarity += first.unit_sectors.col(turned).dot(other.unit_sectors.col(sector));
    ++compared;
  }
  return compared > 0 ? 1.0 - static_cast<double>(similarity) / compared : 1.0;
}

/// The context from offset_m, in the sensor's frame.
ScanContext scan_context_from(const OrganizedCloud& cloud, const Eigen::Vector3f& offset_m) {
  ScanContext result;
  result.unit_sectors.setZero();
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    if (!(cloud.range_m[pixel] > 0.0F)) continue;
    const Eigen::Vector3f p = cloud.points_m[pixel] - offset_m;
    const float ring =
        p.head<2>().norm() * ScanContext::kRings / static_cast<float>(ScanContext::kMaxRange_m);
    if (!(ring < ScanContext::kRings)) continue;  // before the cast: a far point's is no int
    const double azimuth_rad = std::atan2(p.y(), p.x());
    const int sector = wrapped(static_cast<int>(std::floor(azimuth_rad / kSector_rad)));
    float& height_m = result.unit_sectors(static_cast<int>(ring), sector);
    height_m = std::max(height_m, p.z() - kLowest_m);
  }
  for (int sector = 0; sector < ScanContext::kSectors; ++sector) {
    const float length = result.unit_sectors.col(sector).norm();
    result.has_returns[sector] = length > 0.0F;
    if (length > 0.0F) result.unit_sectors.col(sector) /= length;
  }
  return result;
}

}  // namespace

ScanContext scan_context(const OrganizedCloud& cloud) {
  return scan_context_from(cloud, Eigen::Vector3f::Zero());
}

std::vector<ScanContext> scan_contexts_from_lanes(const OrganizedCloud& cloud) {
  std::vector<ScanContext> result;
  for (const float left_m : {0.0F, kLane_m, -kLane_m}) {
    result.push_back(scan_context_from(cloud, {0.0F, left_m, 0.0F}));
  }
  return result;
}

ScanContextMatch compare(const ScanContext& first, const ScanContext& other,
                         double expected_yaw_rad, double max_yaw_error_rad) {
  const int expected = static_cast<int>(std::lround(expected_yaw_rad / kSector_rad));
  const int reach = std::min(static_cast<int>(std::ceil(max_yaw_error_rad / kSector_rad)),
                             ScanContext::kSectors / 2);
  ScanContextMatch best;
  best.yaw_rad = expected * kSector_rad;
  for (int shift = expected - reach; shift <= expected + reach; ++shift) {
    const double distance = distance_at(first, other, shift);
    if (distance < best.distance) best = {distance, shift * kSector_rad};
  }
  return best;
}

}  // namespace hqslam::slam
