#include <algorithm>

#include "../kernels/row_kernels.h"
#include "../kernels/two_modes.h"
#include "two_modes_network.h"

// The loss of the two-mode network and its gradients, from the last layer to the first.
namespace hqslam::nn {
namespace {

/// Of the likelihood of a range, beside the cross-entropy of a return.
constexpr float kRangeShare = 0.3F;

}  // namespace

void TwoModesNetwork::forward_for_training(const RangeImage& measured) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set_);
  take_measured(measured);
  for (int layer = 0; layer < static_cast<int>(layers_.size()); ++layer) {
    Layer& self = layers_[layer];
    for (int row = 0; row < rows_; ++row) {
      if (layer == 0) start_row(row);
      make_input_row(layer, row);
    }
    self.graph.forward(self.values);
    if (layer + 1 == static_cast<int>(layers_.size())) break;
    const Tensor& output = self.values.back();
    for (int row = 0; row < rows_; ++row) {
      for (std::size_t pixel = 0; pixel < computed_.size(); ++pixel) {
        kernels.two_modes(
            {.in = modes_input(layer, pixel, row, output.row(0, row), output.channel_stride()),
             .log_range = self.z.row(static_cast<int>(pixel), row),
             .probability = self.probability.row(static_cast<int>(pixel), row)});
      }
      const int memory = kTwoModesOutputs * static_cast<int>(computed_.size());
      if (memory < output.channels()) {
        next_h_row(layer, row, output.row(memory, row), output.channel_stride());
      } else {
        next_h_row(layer, row, nullptr, 0);
      }
    }
  }
}

/// d loss / d H of a layer, through its input and through the head's middle.
double TwoModesNetwork::backward_layer(int layer, const Tensor& truth, const LossOptions& options,
                                       std::span<float> d_parameters) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set_);
  Layer& self = layers_[layer];
  const bool last = layer + 1 == static_cast<int>(layers_.size());
  Layer* next = last ? nullptr : &layers_[layer + 1];
  const auto pixels = static_cast<int>(computed_.size());
  const float share = (last ? 1.0F : options.layer_share) /
                      (static_cast<float>(pixels) * static_cast<float>(rows_ * columns_));
  const Tensor& output = self.values.back();
  Tensor& d_output = self.gradients.back();
  Tensor& d_h = self.d_h;
  double loss = 0.0;
  for (int row = 0; row < rows_; ++row) {
    for (int pixel = 0; pixel < pixels; ++pixel) {
      const int channel = computed_[pixel].channel;
      const float* d_log_range = nullptr;
      const float* d_probability = nullptr;
      if (next != nullptr) {
        d_log_range = next->d_h.row(channel, row);
        const int first = tile_.pixels() + 2 * tile_.columns;
        d_probability = next->gradients.front().row(first + pixel, row);
      }
      loss += kernels.two_modes_loss(
          {.in = modes_input(layer, pixel, row, output.row(0, row), output.channel_stride()),
           .truth_m = truth.row(channel, row),
           .return_share = share,
           .range_share = share * kRangeShare,
           .d_log_range = d_log_range,
           .d_probability = d_probability,
           .d_outputs = d_output.row(pixel, row),
           .d_group_stride = pixels * d_output.channel_stride(),
           .d_middle = d_h.row(channel, row)});
    }
    if (next != nullptr) {
      const Tensor& d_input = next->gradients.front();
      const int memory = shape_.memory;
      for (int channel = 0; channel < memory; ++channel) {
        std::copy_n(d_input.row(d_input.channels() - memory + channel, row), columns_,
                    d_output.row(kTwoModesOutputs * pixels + channel, row));
      }
    }
  }
  d_output.fill_borders();
  self.graph.backward(self.values, self.gradients, d_parameters);
  const Tensor& d_input = self.gradients.front();
  for (const ComputedPixel& pixel : computed_) {
    for (int row = 0; row < rows_; ++row) {
      const float* from = d_input.row(pixel.channel, row);
      float* to = d_h.row(pixel.channel, row);
      for (int x = 0; x < columns_; ++x) to[x] += 0.5F * from[x];
    }
  }
  return loss;
}

double TwoModesNetwork::add_gradient(const RangeImage& measured, const RangeImage& truth,
                                     const LossOptions& options, std::uint64_t /*seed*/,
                                     std::span<float> d_parameters) {
  check(measured);
  forward_for_training(measured);
  Tensor truth_m(tile_.pixels(), rows_, columns_, ColumnPadding::kCircular);
  to_tiles(truth.range_m.data(), tile_, truth_m);
  double loss = 0.0;
  auto end = static_cast<std::int64_t>(d_parameters.size());
  for (int layer = static_cast<int>(layers_.size()) - 1; layer >= 0; --layer) {
    Layer& self = layers_[layer];
    if (self.gradients.empty()) {
      self.gradients = self.graph.make_values();
      self.d_h = self.h;
    }
    end -= self.parameters;
    const double of_layer =
        backward_layer(layer, truth_m, options, d_parameters.subspan(end, self.parameters));
    if (layer + 1 == static_cast<int>(layers_.size())) loss = of_layer;
  }
  return loss;
}

}  // namespace hqslam::nn
