#include <array>

#include "filter_json.h"
#include "unrolled_hqs.h"

// What a recipe or a weights file says of an unrolled network, beside what every network has.
namespace hqslam::nn {
namespace {

using Json = nlohmann::ordered_json;

struct Preset {
  const char* kind;
  HqsOptions (*options)();
  const char* denoiser;
};
constexpr std::array kPresets{Preset{"du-or", du_or_options, "u-shaped"},
                              Preset{"simple-du", simple_du_options, "plain"}};

const Preset& preset_of(std::string_view kind) {
  return kind == kPresets.back().kind ? kPresets.back() : kPresets.front();
}

/// An option with its names in JSON, in the order of its values.
template <typename Option>
struct Choice {
  const char* field;
  std::array<const char*, 2> names;

  void read(JsonFields& fields, Option& option) const {
    if (fields.has(field))
      option = static_cast<Option>(fields.choice(field, {names.begin(), names.end()}));
  }
  void write(Option option, Json& json) const {
    json[field] = names[static_cast<std::size_t>(option)];
  }
  /// Kinds say it already; JSON only has what is otherwise.
  void write(Option option, Option of_kind, Json& json) const {
    if (option != of_kind) write(option, json);
  }
};
constexpr Choice<Auxiliaries> kAuxiliaries{"auxiliaries", {"z-and-y", "z"}};
constexpr Choice<Start> kStart{"start", {"linear", "zero"}};
constexpr Choice<Penalty> kPenalty{"penalty", {"log-of-each", "alpha"}};
constexpr Choice<FilteredIterate> kFiltered{"filtered_iterate", {"h", "z"}};
constexpr Choice<RejectedPixel> kRejected{"rejected_pixel", {"takes-z", "zero"}};

/// "denoiser": its sizes, and its "kind" if it is not the usual one.
DenoiserDescription read_denoiser(JsonFields& network, const char* usual) {
  JsonFields sizes = network.has("denoiser") ? network.object("denoiser")
                                             : JsonFields(std::string("{}"), "denoiser");
  std::vector<std::string> kinds;
  std::size_t which = 0;
  for (const NamedDenoiser& named : denoisers()) {
    if (std::string_view(named.kind) == usual) which = kinds.size();
    kinds.emplace_back(named.kind);
  }
  if (sizes.has("kind")) which = sizes.choice("kind", kinds);
  DenoiserDescription denoiser = denoisers()[which].read(sizes);
  sizes.finish();
  return denoiser;
}

std::shared_ptr<const Architecture> read(const Preset& preset, JsonFields& network) {
  HqsOptions o = preset.options();
  network.optional("layers", o.layers);
  network.optional("shared_weights", o.shared_weights);
  kAuxiliaries.read(network, o.auxiliaries);
  kStart.read(network, o.start);
  kPenalty.read(network, o.penalty);
  DenoiserDescription denoiser = read_denoiser(network, preset.denoiser);
  read_filter(network, "filter", o.filter);
  o.last_filter = o.filter;
  read_filter(network, "last_filter", o.last_filter);
  kFiltered.read(network, o.filtered);
  kRejected.read(network, o.rejected);
  return std::make_shared<UnrolledHqs>(preset.kind, o, std::move(denoiser));
}

}  // namespace

HqsOptions du_or_options() { return {}; }

HqsOptions simple_du_options() {
  HqsOptions options;
  options.shared_weights = true;
  options.auxiliaries = Auxiliaries::kZ;
  options.start = Start::kZero;
  options.penalty = Penalty::kAlpha;
  return options;
}

std::shared_ptr<const Architecture> read_du_or(JsonFields& network) {
  return read(preset_of("du-or"), network);
}
std::shared_ptr<const Architecture> read_simple_du(JsonFields& network) {
  return read(preset_of("simple-du"), network);
}

void UnrolledHqs::write(Json& network) const {
  const Preset& preset = preset_of(kind_);
  const HqsOptions of_kind = preset.options();
  network["layers"] = options_.layers;
  network["shared_weights"] = options_.shared_weights;
  kAuxiliaries.write(options_.auxiliaries, of_kind.auxiliaries, network);
  kStart.write(options_.start, of_kind.start, network);
  kPenalty.write(options_.penalty, of_kind.penalty, network);
  Json& denoiser = network["denoiser"] = Json::object();
  if (denoiser_.kind != preset.denoiser) denoiser["kind"] = denoiser_.kind;
  denoiser.update(denoiser_.sizes);
  network["filter"] = filter_json(options_.filter);
  network["last_filter"] = filter_json(options_.last_filter);
  kFiltered.write(options_.filtered, network);
  kRejected.write(options_.rejected, network);
}

}  // namespace hqslam::nn
