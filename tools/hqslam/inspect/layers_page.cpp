#include "inspect/layers_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "hqslam/core/angles.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/super_resolver.h"
#include "pages/page.h"

namespace hqslam::tools {
namespace {

using Json = PageJson;

/// Collects the page's images.
class Images {
 public:
  explicit Images(const LayersReport& report) : report_(report) {}

  void begin(std::string group) { group_ = std::move(group); }
  /// what: the name under which the page explains it.
  Json& add(const char* what, const char* kind, int rows, int columns, Json values) {
    json_.push_back({{"group", group_},
                     {"what", what},
                     {"kind", kind},
                     {"rows", rows},
                     {"columns", columns},
                     {"values", std::move(values)}});
    return json_.back();
  }
  /// What is nearer than the sensor's least range counts as no return, as in the result.
  Json& range(const char* what, RangeImage image) {
    for (float& range_m : image.range_m) {
      if (!(range_m >= report_.network.sensor.min_range_m)) range_m = 0.0F;
    }
    return add(what, "range", image.rows, image.columns, range_block(image));
  }
  void share(const char* what, std::span<const float> shares, int rows, int columns) {
    add(what, "share", rows, columns, share_block(shares));
  }
  /// One channel, on a scale of its own: beside a channel of large values one of small ones would
  /// have one colour all over.
  Json& channel(const char* what, const nn::TracedTensor& tensor, int channel) {
    const auto pixels = static_cast<std::size_t>(tensor.rows()) * tensor.columns();
    const std::span<const float> values = tensor.all().subspan(channel * pixels, pixels);
    const auto [low, high] = std::ranges::minmax(values);
    Json& image = add(what, "value", tensor.rows(), tensor.columns(), u16_block(values, low, high));
    image["unit"] = tensor.unit;
    image["low"] = low + 0.0F;  // no zero has a sign
    image["high"] = high + 0.0F;
    return image;
  }
  /// 0: no return, 1: kept, 2: rejected.
  void mask(const RangeImage& filtered, const std::string& tensor) {
    const std::span<const float> rejected = report_.trace.tensor(tensor).all();
    std::vector<std::uint8_t> classes;
    for (std::size_t i = 0; i < rejected.size(); ++i) {
      const bool is_return = filtered.range_m[i] >= report_.network.sensor.min_range_m;
      classes.push_back(rejected[i] != 0.0F ? 2 : is_return ? 1 : 0);
    }
    add("rejected", "mask", filtered.rows, filtered.columns, u8_block(classes));
  }
  Json take() { return std::move(json_); }

 private:
  const LayersReport& report_;
  std::string group_;
  Json json_ = Json::array();
};

/// M, and W^2 / (W^2 + 1), the share of H that the memory has where its mode does not scale it.
void add_input(const LayersReport& report, Images& images) {
  const nn::Trace& trace = report.trace;
  images.begin("Input");
  images.range("measured", report.measured);
  if (trace.has("start")) images.range("start", trace.image("start"));
  if (!trace.has("recalled")) return;
  const std::span<const float> weights = trace.tensor("recalled_weight").all();
  std::vector<float> share(weights.begin(), weights.end());
  for (float& weight : share) weight /= weight + 1.0F;
  const RangeImage recalled = trace.image("recalled");
  images.range("recalled", recalled);
  images.share("recalled_share", share, recalled.rows, recalled.columns);
}

/// filtered: the image that the filter works on, "h" or "z".
void add_layer(const LayersReport& report, int k, const char* filtered, Images& images) {
  const nn::Trace& trace = report.trace;
  const RangeImage z = trace.image(layer_name(k, "z"));
  images.begin(fmt::format("Layer {}", k + 1));
  if (trace.has(layer_name(k, "h"))) images.range("h", trace.image(layer_name(k, "h")));
  if (trace.has("probability")) {
    images.range("mode_1", trace.image("mode_1"));
    images.range("mode_2", trace.image("mode_2"));
    images.share("weight_1", trace.tensor("weight_1").all(), z.rows, z.columns);
    images.share("probability", trace.tensor("probability").all(), z.rows, z.columns);
  }
  for (const char* candidate : {"above", "below", "here", "nothing"}) {
    const std::string what = fmt::format("choice.{}", candidate);
    if (const std::string name = layer_name(k, what.c_str()); trace.has(name)) {
      images.share(what.c_str(), trace.tensor(name).all(), z.rows, z.columns);
    }
  }
  if (const std::string name = layer_name(k, "choice.correction"); trace.has(name)) {
    images.channel("choice.correction", trace.tensor(name), 0);
  }
  images.range("z", z);
  if (const std::string rejected = layer_name(k, "rejected"); trace.has(rejected)) {
    images.mask(trace.image(layer_name(k, filtered)), rejected);
    images.range("y", trace.image(layer_name(k, "y")));
  }
}

/// How the memory changed the result: 0: no return, 1: by 0.1 m at most, 2: nearer to the truth, 3:
/// farther from it, 4: where the truth has no return, or there is no truth.
void add_without_memory(const LayersReport& report, Images& images) {
  constexpr float kSame_m = 0.1F;
  std::vector<std::uint8_t> classes;
  for (std::size_t i = 0; i < report.result.range_m.size(); ++i) {
    const float with_m = report.result.range_m[i];
    const float without_m = report.without_memory->range_m[i];
    const float truth_m = report.truth ? report.truth->range_m[i] : 0.0F;
    const bool nearer = std::abs(with_m - truth_m) < std::abs(without_m - truth_m);
    classes.push_back(std::abs(with_m - without_m) <= kSame_m ? (with_m > 0.0F ? 1 : 0)
                      : truth_m == 0.0F                       ? 4
                      : nearer                                ? 2
                                                              : 3);
  }
  images.range("without_memory", *report.without_memory);
  images.add("memory_change", "change", report.result.rows, report.result.columns,
             u8_block(classes));
}

void add_result(const LayersReport& report, Images& images) {
  images.begin("Result");
  images.range("result", report.result);
  if (!report.confidence.empty()) {
    images.share("confidence", report.confidence, report.result.rows, report.result.columns);
  }
  const int layers = layer_count(report.trace);
  if (has_last_filter(report) && layers > 0) {
    images.mask(report.trace.image(layer_name(layers - 1, "z")), "rejected");
  }
  if (report.without_memory) add_without_memory(report, images);
  for (const Variant& variant : report.variants) {
    images.range("variant", variant.result)["change"] = variant.change;
  }
  if (report.truth) images.range("truth", *report.truth);
}

/// The tensors that were asked for, channel by channel.
void add_tensor(const nn::TracedTensor& tensor, Images& images) {
  images.begin(tensor.name);
  for (int channel = 0; channel < tensor.channels(); ++channel) {
    images.channel("tensor", tensor, channel)["channel"] = channel;
  }
}

Json json_of(const LayerFigures& figures) {
  Json json = {{"name", figures.name}};
  const auto add = [&](const char* key, const auto& value) {
    if (value) json[key] = *value;
  };
  add("penalty", figures.penalty);
  add("rms_h_z_m", figures.rms_h_z_m);
  add("rms_h_y_m", figures.rms_h_y_m);
  add("rms_dh_l_m", figures.rms_dh_l_m);
  add("rejected", figures.rejected);
  add("error_all_m", figures.error_all_m);
  add("error_valid_m", figures.error_valid_m);
  add("wrong_share", figures.wrong_share);
  add("missing_share", figures.missing_share);
  return json;
}

}  // namespace

Json layers_json(const LayersReport& report) {
  const Json network = Json::parse(nn::network_json(report.network));
  const char* filtered = network.value("filtered_iterate", "z") == "h" ? "h" : "z";
  Images images(report);
  add_input(report, images);
  for (int k = 0; k < layer_count(report.trace); ++k) add_layer(report, k, filtered, images);
  add_result(report, images);
  for (const std::string& name : report.tensors) add_tensor(report.trace.tensor(name), images);
  Json data = {{"title", fmt::format("Scan {}, layer by layer", report.scan)},
               {"subtitle",
                fmt::format("{}, upsampled by {}", report.recording, short_name(report.weights))},
               {"network", network},
               {"max_range_m", report.network.sensor.max_range_m},
               {"tolerance_m", nn::SuperResolverOptions{}.tolerance_m},
               {"least_confidence", report.network.least_confidence},
               {"elevation_deg", Json::array()},
               {"measured_rows", Json::array()},
               {"images", images.take()},
               {"layers", Json::array()},
               {"differences", Json::array()}};
  for (const double elevation_rad : report.network.sensor.beam_elevation_rad) {
    data["elevation_deg"].push_back(kDegreesPerRadian * elevation_rad);
  }
  if (!report.pixel.empty()) data["pixel"] = report.pixel;
  for (int row = 0; row < report.result.rows; ++row) {
    if (report.network.measured_rows.contains(row)) data["measured_rows"].push_back(row);
  }
  for (const LayerFigures& figures : layer_figures(report)) {
    data["layers"].push_back(json_of(figures));
  }
  for (const nn::ReferenceDifference& difference : report.differences) {
    data["differences"].push_back({{"name", difference.name},
                                   {"unit", difference.unit},
                                   {"largest", difference.largest},
                                   {"rms", difference.root_mean_square}});
  }
  return data;
}

std::string layers_html(const LayersReport& report) {
  return page_html("layers", layers_json(report));
}

}  // namespace hqslam::tools
