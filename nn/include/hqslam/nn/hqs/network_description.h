#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/hqs/denoiser.h"
#include "hqslam/nn/hqs/outlier_removal.h"

namespace hqslam::nn {

/// The networks of the paper's table.
enum class NetworkKind {
  kDuOr,      ///< U-shaped denoiser, outlier removal in every layer
  kSimpleDu,  ///< plain denoiser, shared by all layers, one auxiliary, no outlier removal inside
};
std::string_view name(NetworkKind kind);  ///< "du-or", "simple-du"

/// Which image the outlier filter of a layer looks at: H (eq. 10c) or Z (the paper's prose).
enum class FilteredIterate { kH, kZ };
/// What Y is where the filter rejects a pixel: Z there, or 0 as eq. 10c has it. A 0 halves the
/// range in the next layer's mean of Z and Y and makes a new ghost; kZero is there to show it.
enum class RejectedPixel { kTakesZ, kZero };

/// Everything about a network but its parameters.
struct NetworkDescription {
  NetworkKind kind = NetworkKind::kDuOr;
  int layers = 5;                 ///< K
  bool shared_weights = false;    ///< one denoiser for all layers
  UShapedDenoiserShape u_shaped;  ///< of kDuOr
  PlainDenoiserShape plain;       ///< of kSimpleDu
  SensorModel sensor;             ///< with all rows
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
/// log b of every layer) or "alpha" (Simple DU: 1 / (2 b), one for all).
std::vector<ParameterShape> parameter_shapes(const NetworkDescription& description);

/// Starting values for training.
std::vector<float> initial_parameters(const NetworkDescription& description, std::uint64_t seed);

}  // namespace hqslam::nn
