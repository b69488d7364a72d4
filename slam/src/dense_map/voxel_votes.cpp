#include "dense_map/voxel_votes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hqslam/slam/dense_map.h"

namespace hqslam::slam {

namespace {

constexpr double kOffsetSteps = 1024.0;  ///< per voxel
constexpr double kOddsSteps = 64.0;      ///< per unit
constexpr double kMostWeight = 16.0;
/// The sums of offsets have 32 bits: 1024 steps times this are 31.
constexpr std::uint32_t kMostWeightSum = 1U << 21U;

constexpr double kIntensitySteps = 1024.0;  ///< per unit
constexpr unsigned kWeightBits = 18;
constexpr std::uint64_t kMostIntensityWeight = (1U << kWeightBits) - 1;
constexpr double kMostIntensity = 262'143.0;  ///< times kMostIntensityWeight fits 46 bits

constexpr double kMeasuredConfidence = 0.95;
constexpr double kMostConfidence = 0.98;  ///< of a computed point
/// Support by a neighbour without a measured point.
constexpr double kComputedSupport = 0.25;

std::uint16_t odds_of(double confidence) {
  return static_cast<std::uint16_t>(std::lround(kOddsSteps * confidence / (1.0 - confidence)));
}

void add_odds(Voxel& voxel, std::uint32_t odds) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  voxel.odds_sum = voxel.odds_sum > kMost - odds ? kMost : voxel.odds_sum + odds;
}

void add_intensity(Voxel& voxel, float intensity, const PointVote& vote) {
  if (!std::isfinite(intensity)) return;
  const std::uint64_t weight = vote.measured ? 1 : vote.weight;
  if ((voxel.intensity_sums & kMostIntensityWeight) + weight > kMostIntensityWeight) return;
  const double steps = std::clamp<double>(intensity, 0.0, kMostIntensity) * kIntensitySteps;
  voxel.intensity_sums +=
      weight * (static_cast<std::uint64_t>(std::lround(steps)) << kWeightBits | 1U);
}

}  // namespace

PointVote measured_vote() {
  return {odds_of(kMeasuredConfidence), static_cast<std::uint8_t>(kMostWeight), true};
}

PointVote computed_vote(float confidence) {
  if (!(confidence >= DenseMapOptions::kLeastPointConfidence)) return {};
  const double c = std::min<double>(confidence, kMostConfidence);
  return {odds_of(c), static_cast<std::uint8_t>(std::ceil(kMostWeight * c)), false};
}

void vote_for(Voxel& voxel, const Eigen::Vector3d& place, const PointVote& vote, std::uint32_t scan,
              float intensity) {
  const bool first_of_scan = voxel.last_scan != scan;
  if (first_of_scan) {
    voxel.last_scan = scan;
    voxel.scan_odds = 0;
    count_up(voxel.times_seen);
  }
  if (vote.odds > voxel.scan_odds) {
    add_odds(voxel, static_cast<std::uint32_t>(vote.odds - voxel.scan_odds));
    voxel.scan_odds = vote.odds;
  }
  if (vote.measured && voxel.times_measured == 0) {
    // From here on measured points alone decide the position.
    voxel.offset_sum = {};
    voxel.weight_sum = 0;
    voxel.intensity_sums = 0;
  }
  if (vote.measured) {
    count_up(voxel.times_measured);
  } else if (voxel.times_measured > 0) {
    return;
  }
  add_intensity(voxel, intensity, vote);
  if (voxel.weight_sum + vote.weight > kMostWeightSum) return;
  voxel.weight_sum += vote.weight;
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = std::clamp(kOffsetSteps * place[axis], 0.0, kOffsetSteps - 1.0);
    voxel.offset_sum[axis] += vote.weight * static_cast<std::uint32_t>(steps);
  }
}

float mean_intensity(const Voxel& voxel) {
  const std::uint64_t weight = voxel.intensity_sums & kMostIntensityWeight;
  if (weight == 0) return std::nanf("");
  return static_cast<float>(static_cast<double>(voxel.intensity_sums >> kWeightBits) /
                            static_cast<double>(weight) / kIntensitySteps);
}

Eigen::Vector3d mean_place(const Voxel& voxel) {
  Eigen::Vector3d place;
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] =
        (static_cast<double>(voxel.offset_sum[axis]) / voxel.weight_sum + 0.5) / kOffsetSteps;
  }
  return place;
}

double support_of(const Voxel& voxel) {
  if (voxel.times_seen_through > voxel.times_seen) return 0.0;
  return voxel.times_measured > 0 ? 1.0 : kComputedSupport;
}

double confidence_of(const Voxel& voxel, double support) {
  const double passes = 1.0 + voxel.times_seen_through;
  const double odds = voxel.odds_sum / kOddsSteps * (1.0 + support) / 2.0 / (passes * passes);
  return odds / (1.0 + odds);
}

}  // namespace hqslam::slam
