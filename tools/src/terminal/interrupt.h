#pragma once

namespace hqslam::tools {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP (the terminal was closed) only asks for a
/// clean stop; the second one ends the program at once. SIGHUP stays ignored where the program was
/// started so (nohup). One at a time.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool stop_requested() const;
};

}  // namespace hqslam::tools
