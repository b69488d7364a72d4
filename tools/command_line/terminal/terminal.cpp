#include "terminal/terminal.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include "hqslam/core/excerpt.h"

namespace hqslam::tools {

namespace {

int g_stdout_errno = 0;  ///< of the first write that failed

void note_stdout(bool written) {
  if (!written && g_stdout_errno == 0) g_stdout_errno = errno;
}

bool write_line(std::FILE* stream, std::string line) {
  line += '\n';
  return std::fwrite(line.data(), 1, line.size(), stream) == line.size();
}

constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
volatile std::sig_atomic_t g_stop_requested = 0;

// Back to the default at once: a user who presses Ctrl-C twice does not want to wait.
extern "C" void request_stop(int signal_number) {
  g_stop_requested = 1;
  std::signal(signal_number, SIG_DFL);
}

}  // namespace

void print_lines(std::string_view lines) {
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    const std::string line = excerpt(lines.substr(0, end), end);
    note_stdout(end < lines.size() ? write_line(stdout, line)
                                   : std::fputs(line.c_str(), stdout) >= 0);
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  note_stdout(std::fflush(stdout) == 0);
}

void print_message(std::string_view line) {
  constexpr std::size_t kMostBytes = 6000;  // more than a path may have
  if (line.ends_with('\n')) line.remove_suffix(1);
  std::string shown = excerpt(line, kMostBytes);
  if (line.size() > kMostBytes) {
    shown = excerpt(line, kMostBytes / 2) +
            excerpt(line.substr(line.size() - kMostBytes / 2), kMostBytes);
  }
  write_line(stderr, shown);
}

void prepare_standard_streams() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest number that is free is this one. A stdout that can only be read fails when it is
    // written, as one that is closed does.
    [[maybe_unused]] const int opened =
        open("/dev/null", descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
  std::signal(SIGPIPE, SIG_IGN);
}

bool all_printed() {
  note_stdout(std::fflush(stdout) == 0);  // --help is not printed here
  if (g_stdout_errno == 0) return true;
  if (g_stdout_errno != EPIPE) {
    to_stderr("hqslam: not everything could be printed ({})\n", std::strerror(g_stdout_errno));
  }
  return false;
}

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
