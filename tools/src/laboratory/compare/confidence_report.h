#pragma once

#include <string>
#include <vector>

#include "laboratory/compare/confidence_curve.h"
#include "report/text_table.h"

namespace hqslam::tools {

/// What `hqslam compare --curve` shows.
struct ConfidenceReport {
  std::string weights;
  std::string recording;
  std::int64_t scans = 0;
  float tolerance_m = 0.0F;  ///< how far off a range may be and count as right
  std::vector<OperatingPoint> points;
  std::vector<ReliabilityBin> reliability;
  double calibration_error = 0.0;
};

/// What every operating point says.
const std::vector<Figure<OperatingPoint>>& operating_figures();
/// A row for each of them.
TextTable operating_table(const std::vector<OperatingPoint>& points);

/// In a page so that the command knows its own.
inline constexpr const char* kConfidencePageMarker = "<!-- hqslam compare --curve -->";

/// A self-contained page: outliers, missing returns and F1 over the confidence, and the reliability
/// diagram.
std::string confidence_html(const ConfidenceReport& report);

}  // namespace hqslam::tools
