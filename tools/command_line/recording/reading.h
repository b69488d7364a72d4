#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "hqslam/core/left_out.h"
#include "hqslam/core/scan_source.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// Why reading came to its end.
enum class ReadingEnd { kRunning, kComplete, kInterrupted, kUnreadableScan };
/// "running", "complete", "interrupted", "unreadable scan"
std::string_view name(ReadingEnd end);

/// Scans by their indices in the recording, both ends included.
struct ScanRange {
  std::int64_t first = 0;
  std::int64_t last = std::numeric_limits<std::int64_t>::max();

  /// How many of a recording's scans they are; nothing where its length is not known.
  std::optional<std::int64_t> count_of(std::optional<std::int64_t> scans) const {
    if (!scans) return std::nullopt;
    return std::max<std::int64_t>(0, std::min(*scans - 1, last) - first + 1);
  }
};

/// How a recording was read, up to now or to its end.
struct Reading {
  ReadingEnd end = ReadingEnd::kRunning;
  std::string end_message;  ///< the reader's, for kUnreadableScan
  LeftOut left_out;
  ScanRange wanted;  ///< the others are read and not used
};

/// A scan that was read, and where.
struct ReadScan {
  RecordedScan scan;
  std::int64_t index = 0;  ///< in the recording, counted from 0; those that were left out count
  double reading_s = 0.0;  ///< what reading and projecting it took
};

/// What has to be seen of the scans after one before that is used.
struct LookAhead {
  std::int64_t scans = 0;                           ///< their number
  std::function<void(const ReadScan& read)> see{};  ///< each scan, as soon as it is read
};

/// Hands every scan that can be understood to `use`, until that returns false, to the recording's
/// end, until Ctrl-C or to a scan that cannot be read. A scan of which `use` throws ScanError is
/// left out as well. Throws Error where not a single scan could be used, or the recording has none
/// of those that are wanted.
void read_scans(ScanSource& source, const InterruptGuard& interrupt, Reading& reading,
                const std::function<bool(const ReadScan& read)>& use,
                const LookAhead& look_ahead = {});

/// "40 of 80 scans", or "40 scans" where their number is unknown.
std::string scans_text(std::int64_t used, std::optional<std::int64_t> in_recording);

/// The ExitStatus of such a reading, of whose scans `used` were used, with the
/// lines on stderr that explain it.
int exit_status_of(const Reading& reading, std::int64_t used,
                   std::optional<std::int64_t> in_recording);

}  // namespace hqslam::tools
