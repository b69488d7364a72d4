#pragma once

#include <memory>

#include "architecture.h"
#include "graph/layer_graph.h"
#include "trainable_architecture.h"

namespace hqslam::nn {

/// SRAE, "Simulation-based lidar super-resolution for ground vehicles" (Shan et al., 2020): a U-Net
/// of convolutions with batch norm and ReLU. F filters, every convolution 3 x 3 with zeros beyond
/// the edges:
///   up.i          transposed, strides 2 x 1, F       until there are all rows
///   encoder.0     two convolutions, F
///   encoder.i     average pool 2 x 2, dropout, two convolutions, 2^i F     i = 1 to 4
///   decoder.i     dropout, transposed `up`, stride 2, 2^(3-i) F; beside it encoder.(3-i); two
///                 convolutions, 2^(3-i) F                                  i = 0 to 3
///   head          1 x 1 with ReLU, 1
/// The paper's F is 64.
struct SraeShape {
  int filters = 8;
  float dropout = 0.25F;
  /// The result is the mean over this number of passes with dropout; a pixel where their standard
  /// deviation is above largest_deviation times the mean comes out empty. 1: one pass without
  /// dropout.
  int passes = 50;
  float largest_deviation = 0.03F;
};
/// The stride of the encoder: rows and columns of the whole image are multiples of it.
inline constexpr int kSraeStride = 16;

/// "srae".
class Srae final : public Architecture, public TrainableArchitecture {
 public:
  /// Throws Error with field, value and constraint.
  explicit Srae(const SraeShape& shape);

  std::string_view name() const override { return "srae"; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override { return kSraeStride; }
  std::vector<ParameterShape> parameter_shapes(
      const NetworkDescription& description) const override;
  std::vector<float> initial_parameters(const NetworkDescription& description,
                                        std::uint64_t seed) const override;
  std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                        InstructionSet instruction_set, int threads) const override;
  std::unique_ptr<TrainableNetwork> make_trainable(const NetworkDescription& description,
                                                   int columns,
                                                   InstructionSet instruction_set) const override;

  /// One channel of measured rows in, one of all rows out.
  LayerGraph graph(const NetworkDescription& description, int columns, const Engine& engine) const;
  const SraeShape& shape() const { return shape_; }

 private:
  SraeShape shape_;
};

std::shared_ptr<const Architecture> read_srae(JsonFields& network);

}  // namespace hqslam::nn
