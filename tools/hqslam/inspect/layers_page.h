#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/reference/reference.h"
#include "hqslam/nn/super_resolver.h"

namespace hqslam::tools {

/// One scan on its way through a network.
struct LayersReport {
  std::string recording;
  std::string weights;
  std::int64_t scan = 0;
  RangeImage measured;              ///< the measured rows
  std::optional<RangeImage> truth;  ///< all rows, if the recording has them
  nn::NetworkDescription network;
  nn::Trace trace;
  std::vector<std::string> tensors;                  ///< names of the trace, to be shown too
  std::vector<nn::ReferenceDifference> differences;  ///< empty: not asked for
  RangeImage result;
  std::vector<float> confidence;  ///< of the result, per pixel; empty: the network has none
  /// The result for the scan alone, if earlier ones were recalled.
  std::optional<RangeImage> without_memory;
};

/// What one layer did, over all its pixels; no return counts as 0 m. A figure that the network does
/// not have is not there.
struct LayerFigures {
  std::string name;  ///< "Layer 1", "Result"
  std::optional<double> penalty;
  std::optional<double> rms_h_z_m;   ///< root mean square of H - Z: by how much the prior moves it
  std::optional<double> rms_h_y_m;   ///< of H - Y: by how much the filter does
  std::optional<double> rms_dh_l_m;  ///< of D H - L: measured rows of H from what was measured
  std::optional<std::int64_t> rejected;  ///< pixels that were rejected, or emptied at the end
  std::optional<double> error_all_m;  ///< mean |range - truth|, measured rows restored, all pixels
  std::optional<double> error_valid_m;  ///< where both have a return
};
/// A row for each layer and one for the result.
std::vector<LayerFigures> layer_figures(const LayersReport& report);

/// What tools/web/layers.html shows: every image in groups (input, layers, result, tensors that
/// were asked for), the figures of layers, and the differences from the reference.
nlohmann::ordered_json layers_json(const LayersReport& report);
std::string layers_html(const LayersReport& report);

}  // namespace hqslam::tools
