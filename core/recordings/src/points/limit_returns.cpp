#include "points/limit_returns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace hqslam::recordings {

namespace {

/// Coordinates are rounded to millimetres; what a scan really measures at its farthest, it measures
/// at many ranges.
constexpr float kSame_m = 0.002F;
constexpr double kLeastShare = 0.02;
/// A surface at one range would have returns beside it, too.
constexpr float kAround_m = 0.1F;
constexpr double kLeastOfAround = 0.9;
/// Fewer are farther: a driver's limit may be below the sensor's.
constexpr double kFarRank = 0.985;
/// More are at one range in images that were made by hand alone.
constexpr double kMostShare = 0.95;
constexpr std::int64_t kFewestReturns = 500;

/// The range below which kFarRank of the returns are; of every seventh pixel.
float far_range_m(const std::vector<float>& range_m) {
  constexpr std::size_t kStep = 7;
  std::vector<float> some_m;
  for (std::size_t i = 0; i < range_m.size(); i += kStep) {
    if (range_m[i] > 0.0F) some_m.push_back(range_m[i]);
  }
  if (some_m.empty()) return 0.0F;
  const auto rank = static_cast<std::ptrdiff_t>(kFarRank * static_cast<double>(some_m.size()));
  std::ranges::nth_element(some_m, some_m.begin() + rank);
  return some_m[static_cast<std::size_t>(rank)];
}

/// Whether these returns are in several rows: those in a single one may be a ring on flat ground.
bool are_in_rows(const std::vector<bool>& is_at_limit, int columns) {
  std::vector<std::int64_t> in_row(is_at_limit.size() / static_cast<std::size_t>(columns));
  for (std::size_t i = 0; i < is_at_limit.size(); ++i) {
    in_row[i / static_cast<std::size_t>(columns)] += is_at_limit[i] ? 1 : 0;
  }
  const std::int64_t all = std::reduce(in_row.begin(), in_row.end());
  return 10 * *std::ranges::max_element(in_row) < 9 * all;
}

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
    const auto returns = std::ranges::count_if(range_m, [](float r) { return r > 0.0F; });
    if (returns < kFewestReturns) return;
    const float limit_m = far_range_m(range_m);
    std::vector<bool> is_at_limit;
    for (const float r : range_m) is_at_limit.push_back(std::abs(r - limit_m) < kSame_m);
    const auto at_limit = std::ranges::count(is_at_limit, true);
    const auto around =
        std::ranges::count_if(range_m, [&](float r) { return std::abs(r - limit_m) < kAround_m; });
    const double share = static_cast<double>(at_limit) / static_cast<double>(returns);
    if (share < kLeastShare || share > kMostShare ||
        static_cast<double>(at_limit) < kLeastOfAround * static_cast<double>(around))
      return;
    if (!are_in_rows(is_at_limit, scan.cloud.columns)) return;
    for (std::size_t i = 0; i < range_m.size(); ++i) {
      if (!is_at_limit[i]) continue;
      range_m[i] = 0.0F;
      scan.cloud.points_m[i].setZero();
    }
    scan.counts.kept -= at_limit;
    scan.counts.out_of_range += at_limit;
    if (!warning_.empty()) return;
    warning_ =
        fmt::format("{}: {} of {} returns are at {:.2f} m: taken as none, here and in other scans",
                    scan.name, at_limit, returns, limit_m);
  }

  std::unique_ptr<ScanSource> source_;
  std::string warning_;
};

}  // namespace

std::unique_ptr<ScanSource> without_limit_returns(std::unique_ptr<ScanSource> source) {
  return std::make_unique<WithoutLimitReturns>(std::move(source));
}

}  // namespace hqslam::recordings
