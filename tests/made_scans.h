#pragma once

#include "hqslam/core/scan_source.h"
#include "testing.h"

namespace hqslam::test {

/// A recording of this many scans of a VLP-16 with stamps, as `make` makes each or throws.
class MadeScans : public ScanSource {
 public:
  MadeScans(std::size_t scans, std::function<RecordedScan(std::size_t scan)> make)
      : scans_(scans), make_(std::move(make)) {}
  const SensorModel& sensor() const override { return sensor_; }
  std::optional<std::int64_t> size() const override { return std::nullopt; }
  double read_share() const override { return 0.0; }
  bool has_stamps() const override { return true; }
  std::optional<RecordedScan> next() override {
    if (next_ == scans_) return std::nullopt;
    return make_(next_++);
  }

 private:
  SensorModel sensor_ = sensor_preset("vlp-16");
  std::size_t scans_;
  std::function<RecordedScan(std::size_t scan)> make_;
  std::size_t next_ = 0;
};

/// Empty scans with these stamps.
inline MadeScans scans_at(std::vector<double> stamps_s) {
  const std::size_t scans = stamps_s.size();
  return {scans, [stamps_s = std::move(stamps_s)](std::size_t i) {
            RecordedScan scan;
            scan.stamp_s = stamps_s[i];
            return scan;
          }};
}

}  // namespace hqslam::test
