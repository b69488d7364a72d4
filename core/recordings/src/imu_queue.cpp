#include "imu_queue.h"

#include <cmath>
#include <utility>

namespace hqslam::recordings {

namespace {

constexpr double kFar_s = 10.0;
/// More than any sensor sends within kFar_s.
constexpr std::size_t kMostWaiting = 20'000;

}  // namespace

void ImuQueue::add(const ImuSample& sample) {
  const bool is_finite = std::isfinite(sample.stamp_s) &&
                         sample.angular_rate_rad_per_s.allFinite() &&
                         sample.specific_force_mps2.allFinite();
  const bool is_later = counts_.used == 0 || sample.stamp_s > last_s_ ||
                        sample.stamp_s < last_s_ - kFar_s;  // the clock was set back
  if (!is_finite || !is_later) {
    ++counts_.left_out;
    return;
  }
  if (waiting_.size() == kMostWaiting) {
    waiting_.pop_front();
    ++counts_.left_out;
    --counts_.used;
  }
  waiting_.push_back(sample);
  last_s_ = sample.stamp_s;
  ++counts_.used;
}

std::vector<ImuSample> ImuQueue::take(double end_s, double offset_s) {
  std::vector<ImuSample> taken;
  std::deque<ImuSample> later;
  for (ImuSample& sample : waiting_) {
    if (!(std::abs(end_s - sample.stamp_s) <= kFar_s)) {
      ++counts_.left_out;
      --counts_.used;
    } else if (sample.stamp_s > end_s) {
      later.push_back(sample);
    } else {
      sample.stamp_s += offset_s;
      taken.push_back(sample);
    }
  }
  waiting_ = std::move(later);
  return taken;
}

}  // namespace hqslam::recordings
