#include "points/limit_returns.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace hqslam::recordings {

namespace {

/// Coordinates are rounded to millimetres; what a scan really measures at its farthest, it measures
/// at many ranges.
constexpr float kSame_m = 0.002F;
constexpr double kLeastShare = 0.02;
/// Images of one range alone are drawn by somebody.
constexpr double kMostShare = 0.95;
constexpr std::int64_t kFewestReturns = 500;

class WithoutLimitReturns : public ScanSource {
 public:
  explicit WithoutLimitReturns(std::unique_ptr<ScanSource> source) : source_(std::move(source)) {}

  const SensorModel& sensor() const override { return source_->sensor(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  double read_share() const override { return source_->read_share(); }
  bool has_stamps() const override { return source_->has_stamps(); }

  std::vector<std::string> warnings() const override {
    std::vector<std::string> warnings = source_->warnings();
    if (!warning_.empty()) warnings.push_back(warning_);
    return warnings;
  }

  std::optional<RecordedScan> next() override {
    std::optional<RecordedScan> scan = source_->next();
    if (scan) take_out(*scan);
    return scan;
  }

 private:
  void take_out(RecordedScan& scan) {
    std::vector<float>& range_m = scan.cloud.range_m;
    if (range_m.empty()) return;
    const float farthest_m = *std::ranges::max_element(range_m);
    const float limit_m = farthest_m - kSame_m;
    const auto returns = std::ranges::count_if(range_m, [](float r) { return r > 0.0F; });
    const auto at_limit = std::ranges::count_if(range_m, [&](float r) { return r > limit_m; });
    if (returns < kFewestReturns) return;
    const double share = static_cast<double>(at_limit) / static_cast<double>(returns);
    if (share < kLeastShare || share > kMostShare) return;
    for (std::size_t i = 0; i < range_m.size(); ++i) {
      if (!(range_m[i] > limit_m)) continue;
      range_m[i] = 0.0F;
      scan.cloud.points_m[i].setZero();
    }
    scan.counts.kept -= at_limit;
    scan.counts.out_of_range += at_limit;
    if (!warning_.empty()) return;
    warning_ = fmt::format(
        "{}: {} of {} returns are at {:.2f} m, the farthest: taken as none, here and in other "
        "scans",
        scan.name, at_limit, returns, farthest_m);
  }

  std::unique_ptr<ScanSource> source_;
  std::string warning_;
};

}  // namespace

std::unique_ptr<ScanSource> without_limit_returns(std::unique_ptr<ScanSource> source) {
  return std::make_unique<WithoutLimitReturns>(std::move(source));
}

}  // namespace hqslam::recordings
