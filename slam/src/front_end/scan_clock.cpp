#include "front_end/scan_clock.h"

namespace hqslam::slam {

namespace {

constexpr double kMinStep_periods = 0.25;
constexpr double kMaxStep_periods = 100.0;

}  // namespace

bool ScanClock::believable(double step_s) const {
  return step_s >= kMinStep_periods * scan_period_s_ && step_s <= kMaxStep_periods * scan_period_s_;
}

double ScanClock::time_s(double stamp_s) {
  double time_s = stamp_s + time_minus_stamp_s_;
  if (last_ && !believable(time_s - last_->time_s)) {
    // A late scan is followed by one in time; a clock that was set runs on from where it is.
    const double step_s = stamp_s - last_->stamp_s;
    const bool was_set = believable(step_s);
    time_s = last_->time_s + (was_set ? step_s : scan_period_s_);
    if (was_set) time_minus_stamp_s_ = time_s - stamp_s;
  }
  last_ = {stamp_s, time_s};
  return time_s;
}

}  // namespace hqslam::slam
