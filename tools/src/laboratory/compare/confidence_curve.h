#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/nn/upsampler.h"
#include "report/page.h"

namespace hqslam::tools {

/// What is left, and how good it is, when computed pixels below a confidence are emptied. Means
/// over the scans; definitions as in `hqslam compare`.
struct OperatingPoint {
  double least_confidence = 0.0;
  double mae_all_m = 0.0;
  double mae_valid_m = 0.0;
  double outlier_share = 0.0;  ///< of all points, farther than 0.5 m from the true cloud
  double missing_share = 0.0;  ///< of the computed pixels' true returns, left empty
  double f1 = 0.0;             ///< of voxels of 0.1 m
};

/// The computed pixels whose confidence lies in one tenth, over all scans.
struct ReliabilityBin {
  double confidence = 0.0;   ///< mean
  double right_share = 0.0;  ///< truth has a return within the tolerance of the pixel's range
  std::int64_t pixels = 0;
};

/// How a network's confidence trades outliers for missing returns, and whether it can be believed.
class ConfidenceCurve {
 public:
  /// network: with confidence 0 as its operating point. Throws Error if it has no confidence.
  /// tolerance_m: the network's, within which a range is right.
  ConfidenceCurve(nn::Upsampler network, float tolerance_m);
  /// truth: a scan with all rows. recalled: for a network with a memory. Throws Error.
  void add(const OrganizedCloud& truth, const nn::RecalledImage& recalled = {});
  std::vector<OperatingPoint> points() const;
  std::vector<ReliabilityBin> reliability() const;
  /// Mean distance of the bins from the diagonal, weighted by their pixels.
  double calibration_error() const;

 private:
  nn::Upsampler network_;
  float tolerance_m_;
  std::vector<OperatingPoint> sums_;
  std::vector<ReliabilityBin> bin_sums_;
  std::int64_t scans_ = 0;
};

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
