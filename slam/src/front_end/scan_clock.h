#pragma once

#include <optional>

namespace hqslam::slam {

/// Time that rises from scan to scan even if the clock of the recording does not.
///
/// In: the stamps of all scans, in order. Out: the time of each, which is the stamp itself while
/// the step from the scan before is plausible: a quarter of a scan period (a sensor may spin faster
/// than its model) to a hundred periods (scans may be missing). Other steps come from late packets
/// or from a clock that was set: the scan then counts as one period later, and the time continues
/// from there if the next stamps do.
class ScanClock {
 public:
  explicit ScanClock(double scan_period_s) : scan_period_s_(scan_period_s) {}
  double time_s(double stamp_s);

 private:
  struct Last {
    double stamp_s;
    double time_s;
  };
  bool is_plausible(double step_s) const;

  double scan_period_s_;
  double time_minus_stamp_s_ = 0.0;
  std::optional<Last> last_;
};

}  // namespace hqslam::slam
