#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../architecture.h"
#include "denoiser.h"
#include "hqs_options.h"

namespace hqslam::nn {

/// The unrolled loop of eq. 10 around a denoiser (unrolled_network.h). Kinds of it, each only a set
/// of options and a denoiser to begin with, which JSON may change:
///   "du-or"      the paper's: a U-shaped denoiser, outlier removal in every layer
///   "simple-du"  a plain denoiser, shared by all layers, one auxiliary from 0, alpha
class UnrolledHqs final : public Architecture {
 public:
  /// Throws Error with field, value and constraint.
  UnrolledHqs(std::string kind, const HqsOptions& options, DenoiserDescription denoiser);

  const HqsOptions& options() const { return options_; }
  const DenoiserDescription& denoiser() const { return denoiser_; }
  /// Denoisers with parameters of their own.
  int denoiser_count() const { return options_.shared_weights ? 1 : options_.layers; }
  int penalty_count() const { return options_.penalty == Penalty::kAlpha ? 1 : options_.layers; }

  std::string_view name() const override { return kind_; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override { return denoiser_.multiple.columns; }
  /// "layers.0.encoder.0.weight", ..., then "log_penalty" or "alpha".
  std::vector<ParameterShape> parameter_shapes(
      const NetworkDescription& description) const override;
  std::vector<float> initial_parameters(const NetworkDescription& description,
                                        std::uint64_t seed) const override;
  std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                        InstructionSet instruction_set, int threads) const override;
  std::optional<OutlierRemovalOptions> last_filter() const override;

 private:
  std::string kind_;
  HqsOptions options_;
  DenoiserDescription denoiser_;
};

/// The options that the kinds begin with.
HqsOptions du_or_options();
HqsOptions simple_du_options();
std::shared_ptr<const Architecture> read_du_or(JsonFields& network);
std::shared_ptr<const Architecture> read_simple_du(JsonFields& network);

/// Of a network that is known to be one.
const UnrolledHqs& unrolled_hqs_of(const NetworkDescription& description);

}  // namespace hqslam::nn
