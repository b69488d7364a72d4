#pragma once

#include <memory>

#include "hqslam/core/scan_source.h"

namespace hqslam::recordings {

/// What becomes of a scan with the same ranges as the one before. Packets number themselves, so
/// that none is read twice.
enum class Repeats { kLeftOut, kKept };

/// The scans of a recording, each once, with stamps that rise.
///
/// - A scan with the same ranges as the one before, as where a message was recorded twice or a
///   driver stood still, is left out (ScanError).
/// - A first scan that is the end of a turn is left out (ScanError).
/// - Two scans that change places, as in a bag that was written out of order, change back.
/// - A single scan that is stamped before the one before is late, and left out (ScanError).
/// - Stamps that stand, or fall and stay behind, are of a clock that is coarse, was not set or set
///   back: they are counted on by the sensor's period until the clock has caught up, with a
///   warning.
std::unique_ptr<ScanSource> ordered(std::unique_ptr<ScanSource> source,
                                    Repeats repeats = Repeats::kLeftOut);

}  // namespace hqslam::recordings
