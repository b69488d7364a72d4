#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/nn/upsampler.h"
#include "report/page.h"

namespace hqslam::tools {

/// What is left, and how good it is, when computed pixels below a confidence are emptied. Means
/// over the scans; definitions as in `hqslam-lab compare`.
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
  std::int64_t scans() const { return scans_; }
  float tolerance_m() const { return tolerance_m_; }

 private:
  nn::Upsampler network_;
  float tolerance_m_;
  std::vector<OperatingPoint> sums_;
  std::vector<ReliabilityBin> bin_sums_;
  std::int64_t scans_ = 0;
};

/// What every operating point says.
const std::vector<Figure<OperatingPoint>>& operating_figures();
/// A row for each of them.
TextTable operating_table(const std::vector<OperatingPoint>& points);

/// In a page so that the command knows its own.
inline constexpr const char* kConfidencePageMarker = "<!-- hqslam-lab compare --curve -->";

/// A self-contained page: outliers, missing returns and F1 over the confidence, and the reliability
/// diagram. `weights`, `recording`: whose it is.
std::string confidence_html(const ConfidenceCurve& curve, const std::string& weights,
                            const std::string& recording);

}  // namespace hqslam::tools
