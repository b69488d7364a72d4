#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unsupported/Eigen/CXX11/Tensor>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/trace.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

/// An inner tensor in double precision: channels x rows x columns, with the names, shapes and units
/// of TracedTensor.
struct ReferenceTensor {
  /// DontAlign: as TracedTensor::Values.
  using Values = Eigen::Tensor<double, 3, Eigen::RowMajor | Eigen::DontAlign>;

  std::string name;
  std::string unit;
  Values values;

  /// All values: channel by channel, row by row.
  std::span<const double> all() const {
    return {values.data(), static_cast<std::size_t>(values.size())};
  }
};

/// In the order in which they are computed.
struct ReferenceTrace {
  std::vector<ReferenceTensor> tensors;
  /// Throws Error if there is none of this name.
  const ReferenceTensor& tensor(std::string_view name) const;
};

struct ReferenceOptions {
  /// The pixels that the filter rejects in each layer, rows x columns; empty: the reference
  /// searches itself. A rounding of a range may connect two pixels or not: a comparison of numbers
  /// gives both sides the same decisions.
  std::vector<std::vector<std::uint8_t>> rejected = {};
  /// M and W^2 of the networks with a memory; empty: nothing is recalled.
  RecalledImage recalled = {};
};

/// The tensors of a network for a scan, written as plainly as its formulas: double precision, one
/// pixel after the other, no tiles in memory, no borders, no threads. A thousand times slower than
/// Network, which is tested against it, and meant to be read first: hqs.cpp is the loop.
/// parameters: all arrays of parameter_shapes(description). measured: the measured rows, metres.
/// "du-or", "simple-du" and "du-mix"; throws Error for others and for other shapes.
ReferenceTrace reference_trace(const NetworkDescription& description,
                               std::span<const double> parameters, const RangeImage& measured,
                               const ReferenceOptions& options = {});

/// How far a trace is from the reference, tensor by tensor.
struct ReferenceDifference {
  std::string name;
  std::string unit;
  double largest = 0.0;
  double root_mean_square = 0.0;
};
/// The differences of all tensors that both have, in the reference's order, but of the filter's
/// masks: they and what is recalled are taken from the trace. Throws Error as reference_trace.
std::vector<ReferenceDifference> differences_from_reference(const NetworkDescription& description,
                                                            std::span<const float> parameters,
                                                            const Trace& trace);

}  // namespace hqslam::nn
