#include "recording/reading.h"

#include <fmt/format.h>

#include <array>
#include <deque>
#include <utility>

#include "hqslam/core/error.h"
#include "timing/timing.h"

namespace hqslam::tools {
namespace {

/// Nothing at the end of the reading, whose reason is noted. Throws Error for a first scan that
/// cannot be read.
std::optional<RecordedScan> next_scan(ScanSource& source, const InterruptGuard& interrupt,
                                      bool is_first, Reading& reading) {
  if (interrupt.stop_requested()) {
    reading.end = ReadingEnd::kInterrupted;
    return std::nullopt;
  }
  try {
    std::optional<RecordedScan> scan = next_usable(source, reading.left_out);
    if (!scan) reading.end = ReadingEnd::kComplete;
    return scan;
  } catch (const Error& error) {
    if (is_first) throw;
    reading.end = ReadingEnd::kUnreadableScan;
    reading.end_message = error.what();
    return std::nullopt;
  }
}

}  // namespace

std::string_view name(ReadingEnd end) {
  constexpr std::array<std::string_view, 4> kNames = {"running", "complete", "interrupted",
                                                      "unreadable scan"};
  return kNames[static_cast<std::size_t>(end)];
}

void read_scans(ScanSource& source, const InterruptGuard& interrupt, Reading& reading,
                const std::function<bool(const ReadScan& read)>& use, const LookAhead& look_ahead) {
  std::deque<ReadScan> waiting;
  std::int64_t seen = 0;
  std::int64_t used = 0;
  std::int64_t refused = 0;  // by `use`; the others that are left out were never seen
  while (true) {
    if (reading.end == ReadingEnd::kRunning && std::ssize(waiting) <= look_ahead.scans) {
      const SteadyClock::time_point start = SteadyClock::now();
      std::optional<RecordedScan> scan = next_scan(source, interrupt, seen == refused, reading);
      // What would have been seen ahead is missing: those that wait would not be as in a whole run.
      if (reading.end == ReadingEnd::kInterrupted) waiting.clear();
      if (!scan) continue;
      const std::int64_t index = seen++ + reading.left_out.scans - refused;
      if (index < reading.wanted.first) continue;
      if (index > reading.wanted.last) {
        reading.end = ReadingEnd::kComplete;
        continue;
      }
      waiting.push_back({std::move(*scan), index, seconds_since(start)});
      if (look_ahead.see) look_ahead.see(waiting.back());
      continue;
    }
    if (waiting.empty()) break;
    const ReadScan read = std::move(waiting.front());
    waiting.pop_front();
    try {
      const bool goes_on = use(read);
      ++used;
      if (goes_on) continue;
      reading.end = ReadingEnd::kComplete;
      reading.end_message.clear();
      break;
    } catch (const ScanError& error) {
      ++refused;
      reading.left_out.add(fmt::format("{}: {}", read.scan.name, error.what()));
    }
  }
  if (used > 0 || reading.end != ReadingEnd::kComplete) return;
  if (seen > 0 && reading.wanted.first >= seen + reading.left_out.scans - refused) {
    throw Error("--scans: begins with scan {}, but the recording ends with scan {}",
                reading.wanted.first, seen + reading.left_out.scans - refused - 1);
  }
  if (reading.left_out.scans > 0) throw Error(reading.left_out.text());
}

std::string scans_text(std::int64_t used, std::optional<std::int64_t> in_recording) {
  return in_recording ? fmt::format("{} of {} scans", used, *in_recording)
                      : fmt::format("{} scans", used);
}

int exit_status_of(const Reading& reading, std::int64_t used,
                   std::optional<std::int64_t> in_recording) {
  const std::string scans = scans_text(used, in_recording);
  if (reading.left_out.scans > 0 && used > 0) to_stderr("hqslam: {}\n", reading.left_out.text());
  switch (reading.end) {
    case ReadingEnd::kInterrupted:
      to_stderr("hqslam: interrupted after {}; the results up to there are valid\n", scans);
      return kInterrupted;
    case ReadingEnd::kUnreadableScan:
      to_stderr("hqslam: {}; stopped after {}, the results up to there are valid\n",
                reading.end_message, scans);
      return kWrongInput;
    default:
      return kOk;
  }
}

}  // namespace hqslam::tools
