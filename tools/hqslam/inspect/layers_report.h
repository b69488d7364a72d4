#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/reference/reference.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/trace.h"

namespace hqslam::tools {

/// Tells a page of this kind from other files.
inline constexpr const char* kLayersPageMarker =
    R"(<meta name="generator" content="hqslam inspect">)";

/// One scan on its way through a network.
struct LayersReport {
  std::string recording;
  std::string weights;
  std::int64_t scan = 0;
  double min_range_m = 0.5;         ///< what is nearer is shown as no return
  double max_range_m = 120.0;       ///< of the colours
  RangeImage measured;              ///< the measured rows
  std::optional<RangeImage> truth;  ///< all rows, if the recording has them
  nn::NetworkDescription network;
  nn::Trace trace;
  std::vector<std::string> tensors;                  ///< of the trace, to be shown by themselves
  std::vector<nn::ReferenceDifference> differences;  ///< empty: not asked for
  RangeImage result;
  std::vector<float> confidence;  ///< of the result, per pixel; of networks that say it
  /// What the network makes of the scan alone; where it recalled earlier ones.
  std::optional<RangeImage> without_memory;
};

/// A page that needs no other file: the tensors that were asked for, the difference from the
/// reference, start, what is recalled of earlier scans, then H, Z, the filter's mask and Y of every
/// layer, the terms of the objective, the result and, with the truth, how far Z is from it.
std::string layers_html(const LayersReport& report);

}  // namespace hqslam::tools
