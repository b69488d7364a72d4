#pragma once

#include <optional>

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
  double time_s(double stamp_s);

 private:
  struct Last {
    double stamp_s;
    double time_s;
  };
  bool believable(double step_s) const;

  double scan_period_s_;
  double time_minus_stamp_s_ = 0.0;
  std::optional<Last> last_;
};

}  // namespace hqslam::slam
