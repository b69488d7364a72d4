#include "hqs_architecture.h"

#include <fmt/format.h>

#include <cmath>

#include "hqs_network.h"
#include "hqslam/core/angles.h"
#include "parameters.h"
#include "plain_prior.h"
#include "two_modes_prior.h"
#include "u_shaped_prior.h"

namespace hqslam::nn {
namespace {

using Json = nlohmann::ordered_json;

constexpr float kFirstPenalty = 0.1F;
constexpr float kFirstAlpha = 10.99F;  // as in the authors' code of Simple DU

/// Replaces what the object `field` names; nothing if there is no such field.
void read_filter(JsonFields& fields, const char* field, OutlierRemovalOptions& filter) {
  if (!fields.has(field)) return;
  JsonFields options = fields.object(field);
  double min_angle_deg = filter.min_angle_rad * kDegreesPerRadian;
  options.optional("min_angle_deg", min_angle_deg);
  filter.min_angle_rad = min_angle_deg / kDegreesPerRadian;
  options.optional("min_pixels", filter.min_pixels);
  options.optional("support_share", filter.support_share);
  options.finish();
}

Json filter_json(const OutlierRemovalOptions& filter) {
  return {{"min_angle_deg", std::round(filter.min_angle_rad * kDegreesPerRadian * 1e9) / 1e9},
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

/// The loop's own choices, beside K and the filters. Throws Error.
void read_loop(const HqsPreset& preset, JsonFields& network, HqsSizes& sizes) {
  sizes.shared = preset.learns_alpha;
  network.optional("shared_weights", sizes.shared);
  if (preset.learns_alpha && !sizes.shared) network.complain("shared_weights", "true");
  if (network.has("penalty")) {
    sizes.fixed_penalty = static_cast<float>(network.number("penalty"));
    if (!(*sizes.fixed_penalty >= 0.0F)) network.complain("penalty", "0 or more");
  }
  if (network.has("filtered_iterate") && network.choice("filtered_iterate", {"h", "z"}) == 1) {
    sizes.filtered_iterate = FilteredIterate::kZ;
  }
  const char* other = sizes.filtered_iterate == FilteredIterate::kH ? "takes-z" : "takes-h";
  if (network.has("rejected_pixel") && network.choice("rejected_pixel", {other, "zero"}) == 1) {
    sizes.rejected_pixel = RejectedPixel::kZero;
  }
}

/// As read_loop reads it.
void write_loop(const HqsSizes& sizes, Json& network) {
  const bool of_h = sizes.filtered_iterate == FilteredIterate::kH;
  network["shared_weights"] = sizes.shared;
  if (sizes.fixed_penalty) network["penalty"] = *sizes.fixed_penalty;
  network["filtered_iterate"] = of_h ? "h" : "z";
  network["rejected_pixel"] = sizes.rejected_pixel == RejectedPixel::kZero ? "zero"
                              : of_h                                       ? "takes-z"
                                                                           : "takes-h";
}

}  // namespace

const HqsPreset kDuOr{.kind = "du-or", .read_prior = read_u_shaped_prior};
const HqsPreset kSimpleDu{.kind = "simple-du",
                          .read_prior = read_plain_prior,
                          .has_y = false,
                          .starts_at_zero = true,
                          .learns_alpha = true};
const HqsPreset kDuMix{.kind = "du-mix",
                       .read_prior = read_two_modes_prior,
                       .has_y = false,
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
    read_loop(preset, network, sizes);
    read_filter(network, "filter", sizes.filter);
    sizes.last_filter = sizes.filter;
  }
  read_filter(network, "last_filter", sizes.last_filter);
  return std::make_shared<HqsArchitecture>(preset, sizes, std::move(prior));
}

HqsArchitecture::HqsArchitecture(const HqsPreset& preset, const HqsSizes& sizes,
                                 PriorDescription prior)
    : preset_(preset), sizes_(sizes), prior_(std::move(prior)) {
  check_field("layers", sizes_.layers, 1, kMostLayers);
  sizes_.shared = sizes_.shared || preset_.learns_alpha;
}

void HqsArchitecture::write(Json& network) const {
  if (preset_.says_confidence) {
    network["denoiser"] = prior_.sizes;
    if (last_filter()) network["last_filter"] = filter_json(*last_filter());
    return;
  }
  network["layers"] = sizes_.layers;
  network["denoiser"] = prior_.sizes;
  network["filter"] = filter_json(sizes_.filter);
  network["last_filter"] = filter_json(sizes_.last_filter);
  write_loop(sizes_, network);
}

void HqsArchitecture::validate(const NetworkDescription& d) const {
  nn::validate(sizes_.filter);
  if (prior_.check) prior_.check(d);
  check_image(prior_, d.sensor.rows(), d.sensor.columns);
  const LayerGraph graph = graph_of(prior_, d);
  const std::int64_t images = 2 * static_cast<std::int64_t>(d.sensor.rows()) * d.sensor.columns;
  check_memory(sizes_.layers * (graph.values() + images), d);
}

std::vector<ParameterShape> HqsArchitecture::parameter_shapes(const NetworkDescription& d) const {
  const std::vector<ParameterShape> of_one = nn::parameter_shapes(prior_, d);
  std::vector<ParameterShape> shapes;
  for (int layer = 0; layer < prior_count(); ++layer) {
    add_part(fmt::format("layers.{}", layer), of_one, shapes);
  }
  if (penalty_count() > 0) {
    shapes.push_back({preset_.learns_alpha ? "alpha" : "log_penalty", {penalty_count()}});
  }
  return shapes;
}

std::vector<float> HqsArchitecture::initial_parameters(const NetworkDescription& d,
                                                       std::uint64_t seed) const {
  std::vector<float> parameters;
  for (int layer = 0; layer < prior_count(); ++layer) {
    const std::vector<float> of_one = nn::initial_parameters(prior_, d, seed * 1000 + layer);
    parameters.insert(parameters.end(), of_one.begin(), of_one.end());
  }
  parameters.insert(parameters.end(), penalty_count(),
                    preset_.learns_alpha ? kFirstAlpha : std::log(kFirstPenalty));
  return parameters;
}

std::unique_ptr<Network> HqsArchitecture::make_network(const NetworkDescription& d, int columns,
                                                       InstructionSet instruction_set,
                                                       int threads) const {
  return std::make_unique<HqsNetwork>(d, columns, instruction_set, threads);
}

std::shared_ptr<const Architecture> HqsArchitecture::for_rows(RowSelection measured_rows) const {
  if (!prior_.with_tile_rows) return nullptr;
  return std::make_shared<HqsArchitecture>(preset_, sizes_,
                                           prior_.with_tile_rows(measured_rows.stride));
}

std::optional<OutlierRemovalOptions> HqsArchitecture::last_filter() const {
  if (sizes_.last_filter.min_pixels == 0) return std::nullopt;
  return sizes_.last_filter;
}

const HqsArchitecture& hqs_of(const NetworkDescription& description) {
  return dynamic_cast<const HqsArchitecture&>(*description.architecture);
}

}  // namespace hqslam::nn
