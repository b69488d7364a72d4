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
  bool has_y = true;            ///< otherwise there is no second auxiliary: Y = Z
  bool starts_at_zero = false;  ///< otherwise with L interpolated over rows
  /// One prior for all layers and one penalty, learned as "alpha" = 1 / (2 b); otherwise as
  /// "log_penalty" = ln b, one for each prior.
  bool learns_alpha = false;
  bool learned_penalty = true;   ///< otherwise b -> 0: what was measured stays
  bool says_confidence = false;  ///< Prior::forward makes the result; one layer, no filter in it
};
extern const HqsPreset kDuOr;      ///< the paper's
extern const HqsPreset kSimpleDu;  ///< the authors' earlier network
extern const HqsPreset kDuMix;     ///< two modes and the odds of a return

inline constexpr int kMostLayers = 20;

/// The image of which eq. 10c makes Y: the paper's equation has H, its prose Z.
enum class FilteredIterate { kH, kZ };
/// What Y is in a pixel that Q rejects: the image that was not filtered (Z of H, H of Z), or the
/// paper's 0, which halves the range in the next layer's mean of Z and Y.
enum class RejectedPixel { kTakesOther, kZero };

/// The choices of a recipe beside the prior.
struct HqsSizes {
  int layers = 5;       ///< K
  bool shared = false;  ///< one prior, and one penalty, for all layers
  /// b of every layer; nothing: learned.
  std::optional<float> fixed_penalty = std::nullopt;
  FilteredIterate filtered_iterate = FilteredIterate::kH;
  RejectedPixel rejected_pixel = RejectedPixel::kTakesOther;
  /// In every layer but the last; with 0 pixels there is none, and Y is the iterate itself.
  OutlierRemovalOptions filter;
  /// On the last Z. Inside, a rejected pixel takes another value; here it comes out empty.
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
  int prior_count() const { return sizes_.shared ? 1 : sizes_.layers; }
  bool learns_penalty() const { return preset_.learned_penalty && !sizes_.fixed_penalty; }
  int penalty_count() const { return learns_penalty() ? prior_count() : 0; }

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
  std::shared_ptr<const Architecture> for_rows(RowSelection measured_rows) const override;
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
