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

/// A computed point nearer than this to a true one is good.
inline constexpr float kGoodDistance_m = 0.2F;

/// How well one way of upsampling does; means over the scans.
struct UpsamplingScore : CloudError {
  std::string method;
  double mae_all_m = 0.0;
  double mae_valid_m = 0.0;
  double missing_share = 0.0;      ///< of the computed pixels' true returns, left empty
  double invented_share = 0.0;     ///< of the computed points, where the truth has no return
  double right_share = 0.0;        ///< of the computed pixels' true returns, within 0.1 m
  double computed_f1 = 0.0;        ///< f1 of the computed points alone
  double outliers_per_scan = 0.0;  ///< as many points
  double upsampling_ms = 0.0;      ///< median
  /// Of the good computed points that the same method gives without the filter at its end, the
  /// share that the filter takes away. Nothing for methods without one.
  std::optional<double> good_lost_share;
};

/// How far one upsampled scan is from the true one.
struct ScanErrors {
  ImageError image;
  CloudError cloud;
  std::int64_t points = 0;  ///< of the upsampled cloud
};
/// cloud: the points of `image`. Throws Error.
ScanErrors scan_errors(const RangeImage& image, const OrganizedCloud& cloud,
                       const OrganizedCloud& truth);

/// Adds the errors of a upsampled scan, of which `measured` was given, to `sum`; `sensor` names its
/// measured rows. Throws Error.
void add_errors(const nn::UpsampledImage& upsampled, const OrganizedCloud& measured,
                const OrganizedCloud& truth, const SensorModel& sensor, UpsamplingScore& sum);
/// Makes the mean of a sum over so many scans.
void make_mean(UpsamplingScore& sum, std::int64_t scans);

/// A weights file in a table: without its folder and ending, if this tells it from the others.
std::string short_name(const std::string& weights, const std::vector<std::string>& all);

/// One way of upsampling and, if it ends with a filter, the same without that.
struct ComparedMethod {
  std::string name;
  nn::Upsampler upsampler;
  std::optional<nn::Upsampler> unfiltered = std::nullopt;
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
  /// How much of a scan is chance: MAE over all pixels, metres, of a method that knows what none
  /// can, the true ranges of the eight pixels around each computed one, and takes their median.
  double true_neighbours_mae_m() const;

 private:
  struct Sums {
    UpsamplingScore sum;
    std::vector<double> times_ms;
    std::int64_t good = 0;
    std::int64_t good_lost = 0;
  };
  void add(ComparedMethod& method, const OrganizedCloud& truth, const nn::RecalledImage& recalled,
           Sums& sums) const;

  std::vector<ComparedMethod> methods_;
  std::vector<Sums> sums_;
  double true_neighbours_mae_sum_m_ = 0.0;
  std::int64_t scans_ = 0;
};

/// What the filter does to one method's results with one choice of its settings; sums over the
/// scans.
struct FilterTrial {
  double min_angle_deg = 0.0;
  int min_pixels = 0;
  double support_share = 0.0;
  std::int64_t bad = 0;  ///< computed points farther than 0.5 m from the true cloud
  std::int64_t bad_removed = 0;
  std::int64_t good = 0;  ///< computed points nearer than 0.2 m
  std::int64_t good_lost = 0;
  std::int64_t points_left = 0;  ///< measured ones too
  double mae_sum_m = 0.0;        ///< over all pixels
  std::int64_t scans = 0;
};

/// Tries settings of the filter at the end on the same results.
class FilterComparison {
 public:
  explicit FilterComparison(nn::Upsampler unfiltered);
  void add(const OrganizedCloud& truth);
  const std::vector<FilterTrial>& trials() const { return trials_; }

 private:
  nn::Upsampler unfiltered_;
  std::vector<FilterTrial> trials_;
};

/// What every step of an unrolled network makes of scans: the scores that it would have if it ended
/// there, its measured rows put back and ranges that the sensor cannot measure taken as no return.
///
/// Of DU-OR and Simple DU: H, Z and, where a layer filters, Y. Of DU-Mix, whose H and Z have a
/// range in every pixel: Z where a return is likelier than none.
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
  /// The steps of one scan, of which the measured rows are given.
  std::vector<Step> steps(const RangeImage& measured);
  RangeImage restored(RangeImage image, const RangeImage& measured) const;

  nn::SuperResolver network_;
  nn::Upsampler linear_;
  std::vector<UpsamplingScore> sums_;
  std::int64_t scans_ = 0;
};

}  // namespace hqslam::tools
