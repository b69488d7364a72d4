#include <utility>

#include "hqslam/core/scan_source.h"

namespace hqslam {

namespace {

class SourceWithImu : public ScanSource {
 public:
  SourceWithImu(std::unique_ptr<ScanSource> source, std::vector<ImuSample> samples)
      : source_(std::move(source)), samples_(std::move(samples)) {}

  const SensorModel& sensor() const override { return source_->sensor(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  double read_share() const override { return source_->read_share(); }
  bool has_stamps() const override { return source_->has_stamps(); }
  std::vector<std::string> warnings() const override { return source_->warnings(); }

  std::optional<RecordedScan> next() override {
    std::optional<RecordedScan> scan = source_->next();
    if (!scan) return scan;
    scan->imu.clear();  // what was given wins over the recording's own
    const double end_s = scan->stamp_s + 0.5 * source_->sensor().scan_period_s;
    for (; next_ < samples_.size() && samples_[next_].stamp_s <= end_s; ++next_) {
      scan->imu.push_back(samples_[next_]);
    }
    return scan;
  }

 private:
  std::unique_ptr<ScanSource> source_;
  std::vector<ImuSample> samples_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<ScanSource> with_imu(std::unique_ptr<ScanSource> source,
                                     std::vector<ImuSample> samples) {
  return std::make_unique<SourceWithImu>(std::move(source), std::move(samples));
}

}  // namespace hqslam
