#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/evaluation/cloud_error.h"
#include "hqslam/evaluation/image_error.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/upsampler.h"

namespace hqslam::tools {

/// Figures of one method of upsampling, means over the scans.
struct UpsamplingScore : CloudError {
  std::string method;
  double mae_all_m = 0.0;
  double mae_valid_m = 0.0;
  double missing_share = 0.0;      ///< computed pixels left empty, of those with a true return
  double invented_share = 0.0;     ///< computed returns where the truth has none, of all computed
  double right_share = 0.0;        ///< computed pixels within 0.1 m, of those with a true return
  double computed_f1 = 0.0;        ///< f1 of the computed points alone
  double outliers_per_scan = 0.0;  ///< number of points
  double upsampling_ms = 0.0;      ///< median
};

/// Adds the errors of an upsampled scan with the measured rows `measured` to `sum`; `sensor` has
/// the selection of these rows. Throws Error.
void add_errors(const nn::UpsampledImage& upsampled, const OrganizedCloud& measured,
                const OrganizedCloud& truth, const SensorModel& sensor, UpsamplingScore& sum);
/// Divides a sum over scans by their number.
void make_mean(UpsamplingScore& sum, std::int64_t scans);

/// The name of a weights file in a table: without folder and extension, if that is unique.
std::string short_name(const std::string& weights, const std::vector<std::string>& all);

struct ComparedMethod {
  std::string name;
  nn::Upsampler upsampler;
};

/// Scores methods scan by scan against recordings that have all rows.
class UpsamplingComparison {
 public:
  explicit UpsamplingComparison(std::vector<ComparedMethod> methods);
  /// truth: a scan with all rows of the methods' sensor. recalled: for networks with a memory.
  /// Throws Error.
  void add(const OrganizedCloud& truth, const nn::RecalledImage& recalled = {});
  /// The first of the methods that has a memory; null: none has.
  const nn::Upsampler* with_memory() const;
  std::vector<UpsamplingScore> scores() const;

 private:
  struct Sums {
    UpsamplingScore sum;
    std::vector<double> times_ms;
  };
  void add(ComparedMethod& method, const OrganizedCloud& truth, const nn::RecalledImage& recalled,
           Sums& sums) const;

  std::vector<ComparedMethod> methods_;
  std::vector<Sums> sums_;
  std::int64_t scans_ = 0;
};

/// The scores of every step of an unrolled network, as if the network ended there: with the
/// measured rows restored, and ranges that the sensor cannot measure taken as no return.
///
/// The steps of DU-OR and Simple DU are H, Z and, where a layer filters, Y; that of DU-Mix, whose H
/// and Z have a range in every pixel, is Z where a return is more probable than none.
class LayerComparison {
 public:
  LayerComparison(nn::SuperResolver network, const SensorModel& sensor);
  /// truth: a scan with all rows of the sensor. Throws Error.
  void add(const OrganizedCloud& truth);
  /// "linear" for comparison, then step after step, then "result".
  std::vector<UpsamplingScore> scores() const;

 private:
  struct Step {
    std::string name;
    RangeImage image;
  };
  /// The steps of one scan with these measured rows.
  std::vector<Step> steps(const RangeImage& measured);
  RangeImage restored(RangeImage image, const RangeImage& measured) const;

  nn::SuperResolver network_;
  nn::Upsampler linear_;
  std::vector<UpsamplingScore> sums_;
  std::int64_t scans_ = 0;
};

}  // namespace hqslam::tools
