#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "data_consistency.h"
#include "denoiser.h"
#include "hqs_options.h"
#include "hqslam/core/range_image.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

/// What one HQS layer computed. Tiles, ranges in units of range_scale_m.
struct LayerState {
  DenoiserState denoiser;              ///< input begins with H, z is Z
  Tensor y;                            ///< Y
  std::vector<std::uint8_t> rejected;  ///< the filter's mask, rows x columns
};

/// One scan on its way through the network, with memory for everything it needs: after it was made
/// nothing allocates.
struct UnrolledState {
  LayerState& layer(int index) { return slots[index % slots.size()]; }
  const LayerState& layer(int index) const { return slots[index % slots.size()]; }

  RangeImage measured;    ///< the scan, in units of range_scale_m
  Tensor l;               ///< measured ranges; its other rows are never looked at
  Candidates candidates;  ///< measured neighbours above and below
  Tensor z0;              ///< start: Z and Y of layer 0
  /// Of all layers, or of the last few: layer k is in slot k mod the number of slots.
  std::vector<LayerState> slots;
  std::vector<float> raster;  ///< rows x columns, for the filter
};

/// The unrolled loop (eq. 10): for each layer
///   H = data consistency(L, Z, Y);  Z = G(H);  Y = H, or Z where the filter rejects H.
/// With Z as the only auxiliary there is no filter inside: Y = Z.
///
/// Holds packed weights and scratch for one image size and one thread team.
class UnrolledNetwork {
 public:
  /// Of a description whose architecture is UnrolledHqs. `columns` may be fewer than the sensor's:
  /// cut-outs for training. Throws Error.
  UnrolledNetwork(const NetworkDescription& description, int columns,
                  InstructionSet instruction_set, int threads);

  const NetworkDescription& description() const { return description_; }
  const HqsOptions& options() const { return options_; }
  TileSize tile() const { return denoisers_.front()->tile(); }
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  std::int64_t multiply_adds() const;
  /// b of a layer.
  float penalty(int layer) const { return penalty_[layer]; }

  /// All arrays of parameter_shapes(description), one after the other. Throws Error.
  void set_parameters(std::span<const float> parameters);

  /// Which layers' values a state keeps: backward and trace need all; two are enough for a result
  /// and stay in the processor's cache.
  enum class Kept { kAllLayers, kLastTwo };
  UnrolledState make_state(Kept kept = Kept::kAllLayers) const;
  /// Puts a scan's measured rows into the state and makes the start Z0 = Y0: interpolated over rows
  /// or zero, as the options say. measured: as many rows as measured_rows says, metres. Throws
  /// Error for another shape.
  void start(const RangeImage& measured, UnrolledState& state) const;
  /// All layers; result(state) is then the last layer's Z. The last layer's Y, which nothing
  /// needs, is left to finish_last_layer. Uses the network's threads.
  void forward(UnrolledState& state, std::optional<std::uint64_t> dropout_seed = std::nullopt);

  const Tensor& result(const UnrolledState& state) const {
    return state.layer(options_.layers - 1).denoiser.z;
  }

  /// The last layer's mask and Y, which nobody has without Y.
  void finish_last_layer(UnrolledState& state);

  /// The parts of `forward`, for measurements, on what it left in the state.
  std::vector<NetworkStep> steps(UnrolledState& state);

  /// d_z: d loss / d Z of the last d_z.size() layers, tiles; the loss does not look at the others.
  /// Adds to d_parameters. The filter's masks are constants. One thread. Throws Error unless the
  /// state keeps all layers and d_z holds one to all of them.
  void backward(const UnrolledState& state, std::span<const Tensor> d_z,
                std::span<float> d_parameters);

 private:
  Denoiser& denoiser(int layer) { return *denoisers_[options_.shared_weights ? 0 : layer]; }
  DataConsistency data_consistency(int layer) const;
  /// Of the last layer nothing needs Y.
  bool has_filter_after(int layer) const {
    return options_.auxiliaries == Auxiliaries::kZAndY && layer + 1 < options_.layers;
  }
  bool filters_h() const;
  /// Y of the layer before, and with it what the denoiser of a layer takes and the image that its
  /// filter looks at, as far as it is known by then. The threads share the rows.
  void make_input(UnrolledState& state, int layer) const;
  void fill_raster_row(int layer, int tile_row, UnrolledState& state) const;
  void start_row(const RangeImage& measured, int row, UnrolledState& state) const;
  void set_y_row(int row, LayerState& layer) const;
  void run_layer(UnrolledState& state, int layer, std::optional<std::uint64_t> dropout_seed);
  const Tensor& previous_z(const UnrolledState& state, int layer) const;
  const Tensor& previous_y(const UnrolledState& state, int layer) const;
  void gather_d_z(int layer, const LayerState& current, const Tensor* d_loss, const Tensor& d_a,
                  Tensor& d_z) const;
  void gather_d_h(int layer, const LayerState& current, const Tensor& d_input, const Tensor& d_a,
                  Tensor& d_h) const;
  void add_penalty_gradient(int layer, double d_penalty, std::span<float> d_parameters) const;

  NetworkDescription description_;
  HqsOptions options_;
  int rows_;
  int columns_;
  int threads_;
  std::vector<std::unique_ptr<Denoiser>> denoisers_;
  std::int64_t denoiser_parameters_ = 0;  ///< of one denoiser
  OutlierRemoval filter_;
  std::vector<float> penalty_;  ///< b of each layer
  float alpha_ = 1.0F;          ///< Penalty::kAlpha's
  /// Scratch of backward, made when first needed.
  struct BackwardScratch;
  std::shared_ptr<BackwardScratch> backward_;
};

}  // namespace hqslam::nn
