#include "interrupt.h"

#include <csignal>

namespace hqslam::tools {
namespace {

volatile std::sig_atomic_t g_stop_requested = 0;

// Back to the default at once: whoever presses Ctrl-C twice does not want to wait.
extern "C" void request_stop(int signal_number) {
  g_stop_requested = 1;
  std::signal(signal_number, SIG_DFL);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  g_stop_requested = 0;
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::stop_requested() const { return g_stop_requested != 0; }

}  // namespace hqslam::tools
