#include "table/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>

namespace hqslam::tools {

namespace {

constexpr std::size_t kResamples = 10000;
constexpr double kBelow = 0.025;
constexpr std::uint64_t kSeed = 20251122;

/// The quantile of the sorted values, interpolated between its neighbours.
double percentile(const std::vector<double>& sorted, double share) {
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double t = position - static_cast<double>(below);
  return (1.0 - t) * sorted[below] + t * sorted[above];
}

}  // namespace

Estimate bootstrap(std::size_t n, const SampleFigure& figure) {
  std::vector<std::size_t> members(n);
  std::iota(members.begin(), members.end(), std::size_t{0});
  Estimate estimate{figure(members), kNoEstimate, kNoEstimate};
  if (n < 2) return estimate;
  std::mt19937_64 random(kSeed);
  std::vector<double> figures;
  for (std::size_t i = 0; i < kResamples; ++i) {
    for (std::size_t& member : members) member = static_cast<std::size_t>(random() % n);
    const double value = figure(members);
    if (std::isfinite(value)) figures.push_back(value);
  }
  if (figures.size() < kResamples / 2) return estimate;
  std::ranges::sort(figures);
  estimate.low = percentile(figures, kBelow);
  estimate.high = percentile(figures, 1.0 - kBelow);
  return estimate;
}

}  // namespace hqslam::tools
