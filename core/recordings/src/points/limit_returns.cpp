#include "points/limit_returns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "wrapped_source.h"

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

/// Whether these pixels are in several rows: those in a single one may be a ring on flat ground.
bool are_in_rows(const std::vector<std::size_t>& pixels, const OrganizedCloud& cloud) {
  std::vector<std::size_t> in_row(static_cast<std::size_t>(cloud.rows));
  for (const std::size_t i : pixels) ++in_row[i / static_cast<std::size_t>(cloud.columns)];
  return 10 * *std::ranges::max_element(in_row) < 9 * pixels.size();
}

/// The pixels that hold a range instead of no return.
std::vector<std::size_t> pixels_at_limit(const OrganizedCloud& cloud) {
  const float limit_m = far_range_m(cloud.range_m);
  std::vector<std::size_t> pixels;
  std::int64_t returns = 0;
  std::int64_t around = 0;
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    const float away_m = std::abs(cloud.range_m[i] - limit_m);
    returns += cloud.range_m[i] > 0.0F ? 1 : 0;
    around += away_m < kAround_m ? 1 : 0;
    if (away_m < kSame_m) pixels.push_back(i);
  }
  const auto at_limit = static_cast<double>(pixels.size());
  const double share = at_limit / static_cast<double>(returns);
  const bool is_limit = returns >= kFewestReturns && share >= kLeastShare && share <= kMostShare &&
                        at_limit >= kLeastOfAround * static_cast<double>(around);
  return is_limit && are_in_rows(pixels, cloud) ? pixels : std::vector<std::size_t>();
}

class WithoutLimitReturns : public WrappedSource {
 public:
  using WrappedSource::WrappedSource;

  std::vector<std::string> warnings() const override {
    std::vector<std::string> warnings = WrappedSource::warnings();
    if (!warning_.empty()) warnings.push_back(warning_);
    return warnings;
  }

  std::optional<RecordedScan> next() override {
    std::optional<RecordedScan> scan = source_->next();
    if (scan) take_out(pixels_at_limit(scan->cloud), *scan);
    return scan;
  }

 private:
  void take_out(const std::vector<std::size_t>& pixels, RecordedScan& scan) {
    if (pixels.empty()) return;
    if (warning_.empty()) {
      warning_ = fmt::format(
          "{}: {} of {} returns are at {:.2f} m: taken as none, here and in other scans", scan.name,
          pixels.size(), scan.counts.kept, scan.cloud.range_m[pixels.front()]);
    }
    for (const std::size_t i : pixels) {
      scan.cloud.range_m[i] = 0.0F;
      scan.cloud.points_m[i].setZero();
    }
    scan.counts.kept -= std::ssize(pixels);
    scan.counts.out_of_range += std::ssize(pixels);
  }

  std::string warning_;
};

}  // namespace

std::unique_ptr<ScanSource> without_limit_returns(std::unique_ptr<ScanSource> source) {
  return std::make_unique<WithoutLimitReturns>(std::move(source));
}

}  // namespace hqslam::recordings
