#include "front_end/scan_clock.h"

namespace hqslam::slam {

namespace {

/// Checked on a real VLP-16 drive with altered stamps.
constexpr double kMinStep_periods = 0.25;
constexpr double kMaxStep_periods = 100.0;

}  // namespace

bool ScanClock::is_plausible(double step_s) const {
  return step_s >= kMinStep_periods * scan_period_s_ && step_s <= kMaxStep_periods * scan_period_s_;
}

double ScanClock::time_s(double stamp_s) {
  double time_s = stamp_s + time_minus_stamp_s_;
  if (last_ && !is_plausible(time_s - last_->time_s)) {
    // After a late scan the stamps go on as before, after a set clock from its new time.
    const double step_s = stamp_s - last_->stamp_s;
    const bool was_set = is_plausible(step_s);
    time_s = last_->time_s + (was_set ? step_s : scan_period_s_);
    if (was_set) time_minus_stamp_s_ = time_s - stamp_s;
  }
  last_ = {stamp_s, time_s};
  return time_s;
}

}  // namespace hqslam::slam
