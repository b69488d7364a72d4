#pragma once

namespace hqslam::slam {

/// Time that runs on from scan to scan, whatever the clock of the recording does.
///
/// In: the stamps of all scans, in order. Out: the time of each, which is the stamp itself as long
/// as it is a believable step later than the scan before: a quarter of a scan period (a sensor may
/// spin faster than its model says) to a hundred periods (scans may be missing). Other steps come
/// from packets that were late or from a clock that was set: a scan then counts as one period
/// later, and if the next stamps run on from there, so does the time.
class ScanClock {
 public:
  explicit ScanClock(double scan_period_s) : scan_period_s_(scan_period_s) {}

  double time_s(double stamp_s) {
    double time_s = stamp_s + time_minus_stamp_s_;
    if (has_last_ && !believable(time_s - last_time_s_)) {
      // A late scan is followed by one in time; a clock that was set runs on from where it is.
      const double step_s = stamp_s - last_stamp_s_;
      const bool was_set = believable(step_s);
      time_s = last_time_s_ + (was_set ? step_s : scan_period_s_);
      if (was_set) time_minus_stamp_s_ = time_s - stamp_s;
    }
    has_last_ = true;
    last_stamp_s_ = stamp_s;
    last_time_s_ = time_s;
    return time_s;
  }

 private:
  static constexpr double kMinStep_periods = 0.25;
  static constexpr double kMaxStep_periods = 100.0;

  bool believable(double step_s) const {
    return step_s >= kMinStep_periods * scan_period_s_ &&
           step_s <= kMaxStep_periods * scan_period_s_;
  }

  double scan_period_s_;
  double time_minus_stamp_s_ = 0.0;
  bool has_last_ = false;
  double last_stamp_s_ = 0.0;
  double last_time_s_ = 0.0;
};

}  // namespace hqslam::slam
