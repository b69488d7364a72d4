#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "architecture.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "prior.h"

namespace hqslam::nn {

/// A kind of network of eq. 10: its prior, and what the loop does around it.
struct HqsPreset {
  const char* kind = "";
  /// Takes the prior's sizes out of "denoiser". Throws Error.
  PriorDescription (*read_prior)(JsonFields& sizes) = nullptr;
  bool filters = true;  ///< Y is what the filter leaves of H; otherwise there is no Y: Y = Z
  bool starts_at_zero = false;  ///< otherwise with L interpolated over rows
  bool shared = false;          ///< one prior and one penalty, "alpha" = 1 / (2 b), for all layers;
                                ///< otherwise one each, "log_penalty" = ln b
  bool learned_penalty = true;  ///< otherwise b -> 0: what was measured stays
  bool says_confidence = false;  ///< Prior::forward makes the result; one layer, no filter in it
};
extern const HqsPreset kDuOr;      ///< the paper's
extern const HqsPreset kSimpleDu;  ///< the authors' earlier network
extern const HqsPreset kDuMix;     ///< two modes and the odds of a return

inline constexpr int kMostLayers = 20;

/// The sizes of such a network in a recipe beside those of its prior.
struct HqsSizes {
  int layers = 5;                ///< K
  OutlierRemovalOptions filter;  ///< in every layer but the last
  /// On the last Z. Inside, a rejected pixel takes Z; here it comes out empty.
  OutlierRemovalOptions last_filter;
};

/// A network of eq. 10 (hqs_loop.h).
class HqsArchitecture final : public Architecture {
 public:
  /// Throws Error with field, value and constraint.
  HqsArchitecture(const HqsPreset& preset, const HqsSizes& sizes, PriorDescription prior);

  const HqsPreset& preset() const { return preset_; }
  const HqsSizes& sizes() const { return sizes_; }
  const PriorDescription& prior() const { return prior_; }
  /// Priors, and penalties, with parameters of their own.
  int prior_count() const { return preset_.shared ? 1 : sizes_.layers; }
  int penalty_count() const { return preset_.learned_penalty ? prior_count() : 0; }

  std::string_view name() const override { return preset_.kind; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override { return prior_.multiple.columns; }
  /// "layers.0.encoder.0.weight", ..., then "log_penalty" or "alpha".
  std::vector<ParameterShape> parameter_shapes(
      const NetworkDescription& description) const override;
  std::vector<float> initial_parameters(const NetworkDescription& description,
                                        std::uint64_t seed) const override;
  std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                        InstructionSet instruction_set, int threads) const override;
  bool has_confidence() const override { return preset_.says_confidence; }
  bool has_scan_memory() const override { return prior_.scan_memory; }
  std::optional<OutlierRemovalOptions> last_filter() const override;

 private:
  HqsPreset preset_;
  HqsSizes sizes_;
  PriorDescription prior_;
};

/// Reads one from a recipe or a weights file. Throws Error.
std::shared_ptr<const Architecture> read_hqs(const HqsPreset& preset, JsonFields& network);

/// The architecture of a network that is known to be one.
const HqsArchitecture& hqs_of(const NetworkDescription& description);

}  // namespace hqslam::nn
