#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "terminal/progress.h"

namespace hqslam::tools {

/// Progress of a table whose drives may run side by side: one bar over the scans of all steps.
/// Safe to call from several threads.
class TableProgress {
 public:
  /// total: scans to be simulated and to be processed, all steps together.
  explicit TableProgress(std::int64_t total) : progress_("table", total) {}
  /// A step begins: "town, linear".
  void step(const std::string& title);
  /// One more scan is done.
  void advance();
  void finish();

 private:
  std::mutex mutex_;
  Progress progress_;
  std::int64_t done_ = 0;
};

}  // namespace hqslam::tools
