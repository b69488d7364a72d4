#pragma once

namespace hqslam::tools {

/// While it lives, the first SIGINT or SIGTERM only asks for a clean stop; the second one ends the
/// program at once. One at a time.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool stop_requested() const;
};

}  // namespace hqslam::tools
