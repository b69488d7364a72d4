#include "ordered_scans.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/error.h"
#include "wrapped_source.h"

namespace hqslam::recordings {

namespace {

/// Two real scans of fewer returns may be the same by chance.
constexpr std::int64_t kFewestReturns = 500;
/// Two scans are exchanged within this many periods: messages are late by less than two.
constexpr double kMostExchanged = 2.5;
/// The scan that follows, and one more, to tell a scan that is late from a clock that was set back.
constexpr std::size_t kAhead = 3;
/// A first scan with returns in less than this share of the columns in which both scans after it
/// have some is the end of a turn.
constexpr double kWholeTurn = 0.75;

/// How many columns have a return.
int seen_columns(const OrganizedCloud& cloud) {
  std::vector<char> is_seen(cloud.columns, 0);
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    if (cloud.range_m[i] > 0.0F) is_seen[i % is_seen.size()] = 1;
  }
  return static_cast<int>(std::ranges::count(is_seen, 1));
}

/// A scan that was read ahead, or why it cannot be understood.
struct Ahead {
  std::optional<RecordedScan> scan;
  std::string complaint = {};
};

class OrderedScans : public WrappedSource {
 public:
  OrderedScans(std::unique_ptr<ScanSource> source, Repeats repeats)
      : WrappedSource(std::move(source)), repeats_(repeats) {}

  std::vector<std::string> warnings() const override {
    std::vector<std::string> warnings = WrappedSource::warnings();
    if (exchanged_ > 0) {
      warnings.push_back(
          fmt::format("{} recorded after a later one: read in the order of their stamps",
                      exchanged_ == 1 ? "1 scan was" : fmt::format("{} scans were", exchanged_)));
    }
    if (counted_on_ > 0) {
      warnings.push_back(fmt::format(
          "{}: stamps repeat or fall back from here on, at {} scan{}: counted on by {} s",
          first_counted_on_, counted_on_, counted_on_ == 1 ? "" : "s", sensor().scan_period_s));
    }
    return warnings;
  }

  std::optional<RecordedScan> next() override {
    read_ahead();
    if (ahead_.empty()) {
      if (broken_) std::rethrow_exception(std::exchange(broken_, nullptr));
      return std::nullopt;
    }
    if (is_exchanged()) {
      std::swap(ahead_[0], ahead_[1]);
      ++exchanged_;
    }
    if (!std::exchange(has_begun_, true)) leave_out_part_of_turn();
    Ahead first = std::move(ahead_.front());
    ahead_.pop_front();
    if (!first.scan) throw ScanError(first.complaint);
    RecordedScan& scan = *first.scan;
    if (is_repeated(scan)) {
      throw ScanError(fmt::format("{}: has the same ranges as the scan before", scan.name));
    }
    set_stamp(scan);
    if (repeats_ == Repeats::kLeftOut) last_range_m_ = scan.cloud.range_m;
    return std::move(first.scan);
  }

 private:
  void read_ahead() {
    while (ahead_.size() < kAhead && !ended_) {
      try {
        std::optional<RecordedScan> scan = source_->next();
        ended_ = !scan;
        if (scan) ahead_.push_back({std::move(scan)});
      } catch (const ScanError& error) {
        ahead_.push_back({std::nullopt, error.what()});
      } catch (const Error&) {
        ended_ = true;
        broken_ = std::current_exception();
      }
    }
  }

  double stamp_s(const RecordedScan& scan) const { return scan.stamp_s + counted_on_s_; }

  bool is_exchanged() const {
    if (ahead_.size() < 2 || !ahead_[0].scan || !ahead_[1].scan) return false;
    const double stamp_0_s = stamp_s(*ahead_[0].scan);
    const double stamp_1_s = stamp_s(*ahead_[1].scan);
    return stamp_1_s < stamp_0_s && (!last_s_ || stamp_1_s > *last_s_) &&
           stamp_0_s - stamp_1_s < kMostExchanged * sensor().scan_period_s;
  }

  /// Drivers that start within a turn write its rest as the first scan. A map would begin with it.
  void leave_out_part_of_turn() {
    if (ahead_.size() < kAhead) return;
    std::vector<int> seen;
    for (const Ahead& ahead : ahead_) {
      if (!ahead.scan) return;
      seen.push_back(seen_columns(ahead.scan->cloud));
    }
    const int whole = std::min(seen[1], seen[2]);
    if (seen[0] >= kWholeTurn * whole) return;
    ahead_.front() = {std::nullopt,
                      fmt::format("{}: has returns in {} columns, the next scans in {}: the "
                                  "recording begins within a turn",
                                  ahead_.front().scan->name, seen[0], whole)};
  }

  bool is_repeated(const RecordedScan& scan) const {
    return repeats_ == Repeats::kLeftOut && scan.counts.kept >= kFewestReturns &&
           scan.cloud.range_m == last_range_m_;
  }

  void set_stamp(RecordedScan& scan) {
    const double own_s = scan.stamp_s;
    if (last_s_ && own_s > *last_s_) counted_on_s_ = 0.0;  // the clock has caught up
    if (last_s_ && !(stamp_s(scan) > *last_s_)) count_on(scan);
    scan.stamp_s = stamp_s(scan);
    last_s_ = scan.stamp_s;
    last_own_s_ = own_s;
  }

  /// A stamp that does not rise. Where the next one does, one that stands is counted on by half of
  /// the step up to it at most, as at the end of a second of whole seconds.
  void count_on(const RecordedScan& scan) {
    const RecordedScan* next =
        !ahead_.empty() && ahead_.front().scan ? &*ahead_.front().scan : nullptr;
    const bool stands = scan.stamp_s == last_own_s_;
    if (!stands && next != nullptr && stamp_s(*next) > *last_s_) {
      throw ScanError(fmt::format("{}: stamped {:.6f} s, not after the scan before ({:.6f} s)",
                                  scan.name, scan.stamp_s, *last_s_ - counted_on_s_));
    }
    double step_s = sensor().scan_period_s;
    if (stands && next != nullptr && next->stamp_s > *last_s_) {
      step_s = std::min(step_s, (next->stamp_s - *last_s_) / 2.0);
    }
    if (counted_on_++ == 0) first_counted_on_ = scan.name;
    counted_on_s_ += *last_s_ + step_s - stamp_s(scan);
  }

  Repeats repeats_;
  std::deque<Ahead> ahead_;
  bool has_begun_ = false;
  bool ended_ = false;
  std::exception_ptr broken_;  ///< why the source cannot be read on
  std::optional<double> last_s_;
  std::vector<float> last_range_m_;
  double last_own_s_ = 0.0;    ///< that of the source
  double counted_on_s_ = 0.0;  ///< what is added to the source's stamps
  std::int64_t counted_on_ = 0;
  std::string first_counted_on_;
  std::int64_t exchanged_ = 0;
};

}  // namespace

std::unique_ptr<ScanSource> ordered(std::unique_ptr<ScanSource> source, Repeats repeats) {
  return std::make_unique<OrderedScans>(std::move(source), repeats);
}

}  // namespace hqslam::recordings
