#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>

namespace hqslam::tools {

/// How far a job over scans, or over something else, has come.
struct ProgressState {
  std::string label;  ///< "run 64x1024"
  std::int64_t done = 0;
  std::optional<std::int64_t> total;  ///< nothing: not known before the end
  double elapsed_s = 0.0;
  std::string unit = "scans";
  double share = 0.0;  ///< done of all, where the total is not known
};

/// "run 64x1024 [#####.....]  50 %  40/80 scans  31.2 scans/s  1.3 s left"
std::string progress_bar(const ProgressState& state);
/// progress_bar without the bar.
std::string progress_line(const ProgressState& state);

/// Shows progress on a stream: a bar that is drawn over on a terminal, otherwise a plain line now
/// and then, so that logs stay short. Safe to call from several threads.
class Progress {
 public:
  Progress(std::string label, std::optional<std::int64_t> total, std::FILE* stream = stderr,
           std::string unit = "scans");
  /// What is being done now.
  void relabel(std::string label);
  /// Call after each scan; draws only when it is time to. share: as ProgressState has it.
  void update(std::int64_t done, double share = 0.0);
  /// One more is done.
  void advance();
  /// Draws the last state and ends the line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  void draw();
  /// A stream that takes nothing costs no work.
  void print(const std::string& text) const;
  void set_done(std::int64_t done);

  std::mutex mutex_;
  std::FILE* stream_;
  bool terminal_;
  ProgressState state_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_ = start_;
};

}  // namespace hqslam::tools
