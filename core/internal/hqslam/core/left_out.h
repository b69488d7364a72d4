#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"

namespace hqslam {

/// Scans of a recording that could not be understood.
struct LeftOut {
  std::int64_t scans = 0;
  std::string first;              ///< what was wrong with the first one
  std::vector<std::string> each;  ///< and with all of them, up to kMostNamed
  static constexpr std::size_t kMostNamed = 1000;

  void add(const std::string& what);
  /// "2 scans were left out, the first of them: ..."
  std::string text() const;
};

/// The next scan that can be understood, or nothing at the end. Throws Error where the recording
/// cannot be read on.
std::optional<RecordedScan> next_usable(ScanSource& source, LeftOut& left_out);

}  // namespace hqslam
