#include "front_end/scattered_returns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace hqslam::slam {

namespace {

/// Where a return has neighbours: so far beside it in its row and in the rows above and below, and
/// at a range that differs by so much.
struct Neighbourhood {
  int columns_beside;
  int columns_above_and_below;
  float tolerance_m;
  float tolerance_share;  ///< of the range, where that is more
  int fewest;             ///< a return with fewer neighbours is scattered
};
/// That of clear air, which edges, posts and leaves meet.
constexpr Neighbourhood kOfClearAir = {3, 1, 0.3F, 0.1F, 2};
/// That of scans with scattered returns: 0.3 to 2 % of the echoes meet it by chance, and 80 % of
/// the returns of surfaces do.
constexpr Neighbourhood kOfFog = {6, 2, 0.15F, 0.05F, 3};
constexpr double kShareInClearAir = 0.1;
/// What stands alone farther away is kept: fog thins surfaces, too, and along a street those that
/// are far away carry the motion.
constexpr float kFarthestEcho_m = 10.0F;

bool is_scattered(const OrganizedCloud& cloud, int row, int column, const Neighbourhood& near) {
  const float range_m = cloud.range_m[cloud.index(row, column)];
  const float tolerance_m = std::max(near.tolerance_m, near.tolerance_share * range_m);
  int missing = near.fewest + 1;  // the return itself is found, too
  for (int i = std::max(row - 1, 0); i <= std::min(row + 1, cloud.rows - 1); ++i) {
    const int reach = i == row ? near.columns_beside : near.columns_above_and_below;
    for (int j = column - reach; j <= column + reach; ++j) {
      const int wrapped = j < 0 ? j + cloud.columns : j < cloud.columns ? j : j - cloud.columns;
      const float other_m = cloud.range_m[cloud.index(i, wrapped)];
      const bool is_near = other_m > 0.0F && std::abs(other_m - range_m) < tolerance_m;
      if (is_near && --missing == 0) return false;
    }
  }
  return true;
}

std::vector<std::uint8_t> scattered_returns(const OrganizedCloud& cloud,
                                            const Neighbourhood& near) {
  std::vector<std::uint8_t> scattered(cloud.range_m.size(), 0);
#pragma omp parallel for schedule(static)
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      const std::size_t pixel = cloud.index(row, column);
      if (cloud.range_m[pixel] > 0.0F) scattered[pixel] = is_scattered(cloud, row, column, near);
    }
  }
  return scattered;
}

}  // namespace

std::optional<OrganizedCloud> without_scattered(const OrganizedCloud& cloud) {
  if (cloud.columns <= kOfFog.columns_beside) return std::nullopt;
  const auto returns = std::ranges::count_if(cloud.range_m, [](float r) { return r > 0.0F; });
  const auto scattered = std::ranges::count(scattered_returns(cloud, kOfClearAir), 1);
  if (static_cast<double>(scattered) <= kShareInClearAir * static_cast<double>(returns)) {
    return std::nullopt;
  }
  OrganizedCloud result = cloud;
  const std::vector<std::uint8_t> emptied = scattered_returns(cloud, kOfFog);
  for (std::size_t pixel = 0; pixel < emptied.size(); ++pixel) {
    if (emptied[pixel] == 0 || result.range_m[pixel] > kFarthestEcho_m) continue;
    result.range_m[pixel] = 0.0F;
    result.points_m[pixel].setZero();
  }
  return result;
}

}  // namespace hqslam::slam
