#include "terminal/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/excerpt.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

constexpr int kBarWidth = 24;
constexpr std::size_t kLabelCharacters = 100;
constexpr double kTerminalInterval_s = 0.1;
constexpr double kPlainInterval_s = 10.0;

double done_share(const ProgressState& state) {
  if (!state.total) return std::clamp(state.share, 0.0, 1.0);
  return *state.total > 0
             ? std::min(1.0, static_cast<double>(state.done) / static_cast<double>(*state.total))
             : 1.0;
}

std::string duration_text(double seconds) {
  if (seconds < 60.0) {
    return fmt::format("{:.0f} s", seconds);
  }
  const auto whole = std::llround(seconds);
  return fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

/// "40/80 scans  31.2 scans/s  1 s left", without "/80" where the total is not known; the last two
/// only once something was done.
std::string counts_text(const ProgressState& state) {
  std::string text = state.total ? fmt::format("{}/{} {}", state.done, *state.total, state.unit)
                                 : fmt::format("{} {}", state.done, state.unit);
  if (state.done > 0 && state.elapsed_s > 0.0) {
    const double done_per_s = static_cast<double>(state.done) / state.elapsed_s;
    text += fmt::format("  {:.1f} {}/s", done_per_s, state.unit);
    if (const double share = done_share(state); share > 0.0 && share < 1.0) {
      const double left_s = state.elapsed_s * (1.0 - share) / share;
      text += fmt::format("  {} left", duration_text(left_s));
    } else {
      text += fmt::format("  {}", duration_text(state.elapsed_s));
    }
  }
  return text;
}

}  // namespace

std::string progress_bar(const ProgressState& state) {
  const auto filled = static_cast<int>(done_share(state) * kBarWidth);
  return fmt::format("{} [{:#<{}}{:.<{}}] {:3.0f} %  {}", excerpt(state.label, kLabelCharacters),
                     "", filled, "", kBarWidth - filled, 100.0 * done_share(state),
                     counts_text(state));
}

std::string progress_line(const ProgressState& state) {
  return fmt::format("{}: {}", excerpt(state.label, kLabelCharacters), counts_text(state));
}

Progress::Progress(std::string label, std::optional<std::int64_t> total, std::FILE* stream,
                   std::string unit)
    : stream_(stream), terminal_(isatty(fileno(stream)) == 1) {
  state_.label = std::move(label);
  state_.total = total;
  state_.unit = std::move(unit);
}

void Progress::relabel(std::string label) {
  const std::lock_guard lock(mutex_);
  state_.label = std::move(label);
}

void Progress::update(std::int64_t done, double share) {
  const std::lock_guard lock(mutex_);
  state_.share = share;
  set_done(done);
}

void Progress::advance() {
  const std::lock_guard lock(mutex_);
  set_done(state_.done + 1);
}

void Progress::set_done(std::int64_t done) {
  state_.done = done;
  const double since_last_s = std::chrono::duration<double>(Clock::now() - last_drawn_).count();
  if (since_last_s >= (terminal_ ? kTerminalInterval_s : kPlainInterval_s)) draw();
}

void Progress::print(const std::string& text) const {
  std::fwrite(text.data(), 1, text.size(), stream_);
  std::fflush(stream_);
}

void Progress::draw() {
  last_drawn_ = Clock::now();
  state_.elapsed_s = std::chrono::duration<double>(last_drawn_ - start_).count();
  if (terminal_) {
    print(fmt::format("\r{}\x1b[K", progress_bar(state_)));
  } else {
    print(fmt::format("{}\n", progress_line(state_)));
  }
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  draw();
  if (terminal_) print("\n");
}

}  // namespace hqslam::tools
