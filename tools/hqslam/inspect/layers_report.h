#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/reference/reference.h"
#include "hqslam/nn/trace.h"

namespace hqslam::tools {

/// What a network with other settings of its loop makes of the scan.
struct Variant {
  std::string change;  ///< "b=0.5,no-q"
  RangeImage result;
};

/// What a network makes of one scan, layer by layer.
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
  std::vector<int> pixel;  ///< row and column of the one that is followed; empty: the page chooses
  std::vector<Variant> variants;  ///< the same scan through a changed network
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
  /// Share of the computed pixels with a return that is off by more than kWrong_m, or where
  /// the truth has none.
  std::optional<double> wrong_share;
  std::optional<double> missing_share;  ///< of the truth's returns in computed pixels, the empty
};
inline constexpr float kWrong_m = 1.0F;
/// A row for each layer, one for the result, and one for the result of each variant.
std::vector<LayerFigures> layer_figures(const LayersReport& report);
/// The number of layers of eq. 10 that the trace has.
int layer_count(const nn::Trace& trace);
/// "layers.2.h" for 2, "h".
std::string layer_name(int k, const char* what);
/// Whether a filter removed outliers from the result. Networks with a confidence have none.
bool has_last_filter(const LayersReport& report);

/// The figures as a table, and one pixel of them as a table by layer, both with a line for each
/// layer and a last one for the result.
std::string figures_text(const LayersReport& report);
/// Throws Error if the image has no such pixel.
std::string pixel_text(const LayersReport& report);

}  // namespace hqslam::tools
