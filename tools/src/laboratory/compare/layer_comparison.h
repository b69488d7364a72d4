#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/upsampler.h"
#include "laboratory/compare/upsampling_comparison.h"

namespace hqslam::tools {

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
