#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/hqs/denoiser.h"
#include "hqslam/nn/hqs/outlier_removal.h"

namespace hqslam::nn {

/// The networks of the paper's table, and one with another output.
enum class NetworkKind {
  kDuOr,      ///< U-shaped denoiser, outlier removal in every layer
  kSimpleDu,  ///< plain denoiser, shared by all layers, one auxiliary, no outlier removal inside
  kDuMix,     ///< a mixture of two modes and the probability of a return for every pixel
};
std::string_view name(NetworkKind kind);  ///< "du-or", "simple-du", "du-mix"

/// Which image the outlier filter of a layer looks at: H (eq. 10c) or Z (the paper's prose).
enum class FilteredIterate { kH, kZ };
/// What Y is where the filter rejects a pixel: Z there, or 0 as eq. 10c has it. A 0 halves the
/// range in the next layer's mean of Z and Y and makes a new ghost; kZero is there to show it.
enum class RejectedPixel { kTakesZ, kZero };

/// The denoiser of one layer of kDuMix, on tiles:
///   encoder.0      3x3 with a bias per row, the input -> channels
///   encoder.1      3x3, stride 2, channels -> lower_channels
///   bottleneck.0   3x3, lower_channels -> as many
///   bottleneck.i   3x3 plus its input, i = 1 to residual_blocks
///   decoder.0      2x2 transposed, stride 2, lower_channels -> channels, plus encoder.0
///   head           1x1, channels -> 7 outputs (two_modes.h) of every computed pixel, memory
/// with leaky ReLU after all but the head.
struct TwoModesLayerShape {
  int channels = 48;
  int lower_channels = 72;
  int residual_blocks = 4;
};
struct TwoModesShape {
  TileSize tile{4, 4};  ///< one measured row in each
  std::vector<TwoModesLayerShape> layers = std::vector<TwoModesLayerShape>(1);
  int memory = 16;  ///< channels that a layer hands to the next beside what it says of the pixels
  float negative_slope = 0.1F;
};

/// Everything about a network but its parameters.
struct NetworkDescription {
  NetworkKind kind = NetworkKind::kDuOr;
  int layers = 5;                 ///< K
  bool shared_weights = false;    ///< one denoiser for all layers
  UShapedDenoiserShape u_shaped;  ///< of kDuOr
  PlainDenoiserShape plain;       ///< of kSimpleDu
  TwoModesShape two_modes;        ///< of kDuMix; as many layers as `layers` says
  /// kDuMix: computed pixels with a smaller confidence come out empty. Chosen after training, so
  /// that as many true returns are missing as linear interpolation misses.
  float least_confidence = 0.1F;
  /// kDuMix: what the mixture says, to this power, is the confidence. Fitted after training on
  /// scans that were not trained on, so that the confidence is the share that is right.
  float confidence_exponent = 1.0F;
  SensorModel sensor;  ///< with all rows
  RowSelection measured_rows;
  float range_scale_m = 80.0F;   ///< ranges are divided by it
  OutlierRemovalOptions filter;  ///< in every layer
  /// On the last Z. Inside, a rejected pixel only takes Z; here it is lost, or a ghost stays.
  OutlierRemovalOptions last_filter;
  FilteredIterate filtered = FilteredIterate::kH;
  RejectedPixel rejected = RejectedPixel::kTakesZ;
};

/// How the network's images are cut into tiles.
TileSize tile_of(const NetworkDescription& description);

/// Throws Error with field, value and constraint.
void validate(const NetworkDescription& description);

/// The arrays of the whole network: "layers.0.encoder.0.weight", ..., then "log_penalty" (DU-OR:
/// log b of every layer) or "alpha" (Simple DU: 1 / (2 b), one for all); DU-Mix has neither.
std::vector<ParameterShape> parameter_shapes(const NetworkDescription& description);

/// Starting values for training.
std::vector<float> initial_parameters(const NetworkDescription& description, std::uint64_t seed);

}  // namespace hqslam::nn
