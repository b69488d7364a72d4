#include <cmath>
#include <numbers>

#include "hqs_architecture.h"
#include "plain_prior.h"
#include "two_modes_prior.h"
#include "u_shaped_prior.h"

// The kinds of networks of eq. 10, and what a recipe or a weights file says of one.
namespace hqslam::nn {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Replaces what the object `field` names; nothing if there is no such field.
void read_filter(JsonFields& fields, const char* field, OutlierRemovalOptions& filter) {
  if (!fields.has(field)) return;
  JsonFields options = fields.object(field);
  double min_angle_deg = filter.min_angle_rad * kDegrees;
  options.optional("min_angle_deg", min_angle_deg);
  filter.min_angle_rad = min_angle_deg / kDegrees;
  options.optional("min_pixels", filter.min_pixels);
  options.optional("support_share", filter.support_share);
  options.finish();
}

Json filter_json(const OutlierRemovalOptions& filter) {
  return {{"min_angle_deg", std::round(filter.min_angle_rad * kDegrees * 1e9) / 1e9},
          {"min_pixels", filter.min_pixels},
          {"support_share", std::round(filter.support_share * 1e6) / 1e6}};
}

PriorDescription read_prior(const HqsPreset& preset, JsonFields& network) {
  JsonFields sizes = network.has("denoiser") ? network.object("denoiser")
                                             : JsonFields(std::string("{}"), "denoiser");
  PriorDescription prior = preset.read_prior(sizes);
  sizes.finish();
  return prior;
}

/// Files say these three, which once could be otherwise.
void check_fixed(const HqsPreset& preset, JsonFields& network) {
  bool shared = preset.shared;
  network.optional("shared_weights", shared);
  if (shared != preset.shared) {
    network.complain("shared_weights", preset.shared ? "true" : "false");
  }
  if (network.has("filtered_iterate")) network.choice("filtered_iterate", {"h"});
  if (network.has("rejected_pixel")) network.choice("rejected_pixel", {"takes-z"});
}

}  // namespace

const HqsPreset kDuOr{.kind = "du-or", .read_prior = read_u_shaped_prior};
const HqsPreset kSimpleDu{.kind = "simple-du",
                          .read_prior = read_plain_prior,
                          .filters = false,
                          .starts_at_zero = true,
                          .shared = true};
const HqsPreset kDuMix{.kind = "du-mix",
                       .read_prior = read_two_modes_prior,
                       .filters = false,
                       .learned_penalty = false,
                       .says_confidence = true};

std::shared_ptr<const Architecture> read_hqs(const HqsPreset& preset, JsonFields& network) {
  HqsSizes sizes;
  PriorDescription prior = read_prior(preset, network);
  if (preset.says_confidence) {
    sizes.layers = 1;
    sizes.last_filter.min_pixels = 0;
  } else {
    network.optional("layers", sizes.layers);
    check_fixed(preset, network);
    read_filter(network, "filter", sizes.filter);
    sizes.last_filter = sizes.filter;
  }
  read_filter(network, "last_filter", sizes.last_filter);
  return std::make_shared<HqsArchitecture>(preset, sizes, std::move(prior));
}

std::shared_ptr<const Architecture> read_du_or(JsonFields& network) {
  return read_hqs(kDuOr, network);
}
std::shared_ptr<const Architecture> read_simple_du(JsonFields& network) {
  return read_hqs(kSimpleDu, network);
}
std::shared_ptr<const Architecture> read_du_mix(JsonFields& network) {
  return read_hqs(kDuMix, network);
}

void HqsArchitecture::write(Json& network) const {
  if (preset_.says_confidence) {
    network["denoiser"] = prior_.sizes;
    if (last_filter()) network["last_filter"] = filter_json(*last_filter());
    return;
  }
  network["layers"] = sizes_.layers;
  network["shared_weights"] = preset_.shared;
  network["denoiser"] = prior_.sizes;
  network["filter"] = filter_json(sizes_.filter);
  network["last_filter"] = filter_json(sizes_.last_filter);
  network["filtered_iterate"] = "h";
  network["rejected_pixel"] = "takes-z";
}

}  // namespace hqslam::nn
