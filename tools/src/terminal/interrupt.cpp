#include "terminal/interrupt.h"

#include <array>
#include <csignal>

namespace hqslam::tools {
namespace {

constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
volatile std::sig_atomic_t g_stop_requested = 0;

// Back to the default at once: whoever presses Ctrl-C twice does not want to wait.
extern "C" void request_stop(int signal_number) {
  g_stop_requested = 1;
  std::signal(signal_number, SIG_DFL);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  g_stop_requested = 0;
  for (const int number : kSignals) {
    const bool ignored = std::signal(number, request_stop) == SIG_IGN;
    if (ignored && number == SIGHUP) std::signal(number, SIG_IGN);
  }
}

InterruptGuard::~InterruptGuard() {
  for (const int number : kSignals) {
    if (std::signal(number, SIG_DFL) == SIG_IGN) std::signal(number, SIG_IGN);
  }
}

bool InterruptGuard::stop_requested() const { return g_stop_requested != 0; }

}  // namespace hqslam::tools
