#include "imu/imu_buffer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hqslam::slam {

namespace {

constexpr double kMostMissing_s = 0.05;
constexpr double kMostLate_s = 10.0;
/// Three times the widest ranges of such sensors (2000 degrees a second, 30 g).
constexpr double kMostRate_rad_per_s = 100.0;
constexpr double kMostForce_mps2 = 1000.0;

/// False for values that are not finite.
bool is_possible(const ImuSample& sample) {
  return std::isfinite(sample.stamp_s) &&
         sample.angular_rate_rad_per_s.norm() <= kMostRate_rad_per_s &&
         sample.specific_force_mps2.norm() <= kMostForce_mps2;
}

/// A rate this far from those before and after it, closer than kMostMissing_s, is wrong: a hand at
/// 200 degrees a second, 100 times a second, stays within 0.1 rad/s.
constexpr double kSpike_rad_per_s = 10.0;

/// Replaces the last sample but one if its rate is a spike.
void flatten_spike(std::deque<ImuSample>& samples) {
  if (samples.size() < 3) return;
  const auto last = samples.end() - 1;
  const auto [before, after] =
      std::pair(last[-2].angular_rate_rad_per_s, last->angular_rate_rad_per_s);
  Eigen::Vector3d& rate = last[-1].angular_rate_rad_per_s;
  const bool is_dense = last->stamp_s - last[-2].stamp_s < kMostMissing_s;
  const double off = std::min((rate - before).norm(), (rate - after).norm());
  if (is_dense && off > kSpike_rad_per_s + 3.0 * (after - before).norm()) {
    rate = 0.5 * (before + after);
  }
}

}  // namespace

Eigen::Vector3d mean_specific_force_mps2(const std::vector<ImuStep>& steps) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double duration_s = 0.0;
  for (const ImuStep& step : steps) {
    sum += step.duration_s * step.specific_force_mps2;
    duration_s += step.duration_s;
  }
  return sum / duration_s;
}

void ImuBuffer::add(const std::vector<ImuSample>& samples) {
  for (const ImuSample& sample : samples) {
    if (!is_possible(sample)) continue;
    while (!samples_.empty() && samples_.back().stamp_s > sample.stamp_s + kMostLate_s) {
      samples_.pop_back();
    }
    const bool is_later = samples_.empty() || sample.stamp_s > samples_.back().stamp_s;
    if (!is_later) continue;
    samples_.push_back(sample);
    flatten_spike(samples_);
  }
}

std::vector<ImuStep> ImuBuffer::steps(double from_s, double to_s,
                                      const Eigen::Matrix3d& R_level_sensor) const {
  if (samples_.empty() || samples_.front().stamp_s > from_s + kMostMissing_s ||
      samples_.back().stamp_s < to_s - kMostMissing_s) {
    return {};
  }
  std::vector<ImuStep> result;
  // The last sample that began before from_s.
  auto sample = std::ranges::upper_bound(samples_, from_s, {}, &ImuSample::stamp_s);
  if (sample != samples_.begin()) --sample;
  for (double time_s = from_s; time_s < to_s; ++sample) {
    const auto next = std::next(sample);
    const bool is_last = next == samples_.end();
    if (!is_last && next->stamp_s - sample->stamp_s > kMostMissing_s) return {};
    const double end_s = is_last ? to_s : std::min(to_s, 0.5 * (sample->stamp_s + next->stamp_s));
    if (end_s <= time_s) continue;
    result.push_back({end_s - time_s, R_level_sensor * sample->angular_rate_rad_per_s,
                      R_level_sensor * sample->specific_force_mps2});
    time_s = end_s;
  }
  return result;
}

void ImuBuffer::forget_before(double stamp_s) {
  while (samples_.size() > 1 && samples_[1].stamp_s < stamp_s) samples_.pop_front();
}

}  // namespace hqslam::slam
