#include "inspect/layers_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "hqslam/evaluation/image_error.h"
#include "hqslam/evaluation/png.h"
#include "report/page.h"

namespace hqslam::tools {
namespace {

constexpr Rgb kRejected = {235, 60, 50};

/// Grey where the filter keeps a pixel, red where it rejects it, black without a return.
RgbImage mask_image(const RangeImage& filtered, double min_range_m,
                    const std::vector<float>& rejected) {
  RgbImage image{filtered.rows, filtered.columns, {}};
  for (std::size_t i = 0; i < filtered.range_m.size(); ++i) {
    const std::uint8_t grey = filtered.range_m[i] >= min_range_m ? 150 : 0;
    image.pixels.push_back(rejected[i] != 0.0F ? kRejected : Rgb{grey, grey, grey});
  }
  return image;
}

/// White where a range is right, darker red the farther it is off (0.1 m to 10 m, logarithmic).
RgbImage error_image(const RangeImage& image, const RangeImage& truth) {
  RgbImage colours{image.rows, image.columns, {}};
  for (std::size_t i = 0; i < image.range_m.size(); ++i) {
    const double error_m = std::abs(image.range_m[i] - truth.range_m[i]);
    const double share = std::clamp(0.5 + 0.5 * std::log10(std::max(error_m, 1e-3)), 0.0, 1.0);
    colours.pixels.push_back({static_cast<std::uint8_t>(255.0 - 75.0 * share),
                              static_cast<std::uint8_t>(255.0 - 235.0 * share),
                              static_cast<std::uint8_t>(255.0 - 215.0 * share)});
  }
  return colours;
}

/// White where something is certain, black where it is ruled out.
RgbImage share_image(const std::vector<float>& shares, int rows, int columns) {
  RgbImage image{rows, columns, {}};
  for (const float share : shares) {
    const auto grey =
        static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F)));
    image.pixels.push_back({grey, grey, grey});
  }
  return image;
}

/// Where the result is another than without a memory, by more than 0.1 m: of the truth's returns
/// whether it came nearer (green) or went away (red), of the others, or all, orange.
RgbImage decided_image(const LayersReport& report) {
  constexpr Rgb kNearer = {40, 190, 90};
  constexpr Rgb kChanged = {245, 160, 40};
  constexpr float kSame_m = 0.1F;
  RgbImage image{report.result.rows, report.result.columns, {}};
  for (std::size_t i = 0; i < report.result.range_m.size(); ++i) {
    const float with_m = report.result.range_m[i];
    const float without_m = report.without_memory->range_m[i];
    const float truth_m = report.truth ? report.truth->range_m[i] : 0.0F;
    const std::uint8_t grey = with_m > 0.0F ? 90 : 0;
    Rgb colour = {grey, grey, grey};
    if (std::abs(with_m - without_m) > kSame_m) {
      const bool nearer = std::abs(with_m - truth_m) < std::abs(without_m - truth_m);
      colour = truth_m == 0.0F ? kChanged : nearer ? kNearer : kRejected;
    }
    image.pixels.push_back(colour);
  }
  return image;
}

/// The page of a report, while it is being written.
struct LayersPage : Page {
  explicit LayersPage(const LayersReport& shown)
      : Page(fmt::format("Layers of scan {}", shown.scan)), report(shown), trace(shown.trace) {}

  void ranges(RangeImage image, std::string_view caption) {
    for (float& range_m : image.range_m) {
      if (!(range_m >= report.min_range_m)) range_m = 0.0F;
    }
    picture(color_by_range(image, report.max_range_m), caption);
  }
  void mask(const RangeImage& filtered, const std::string& tensor, const char* caption) {
    picture(mask_image(filtered, report.min_range_m, trace.image(tensor).range_m), caption);
  }
  /// How far an image is from the truth; `what` names both and the mean error.
  void error(const RangeImage& image, const std::string& what) {
    picture(error_image(image, *report.truth),
            what + ": white 0.1 m and less, dark red 10 m and more");
  }
  /// The image of a layer's tensor.
  RangeImage image_of(std::size_t k, const char* what) const {
    return trace.image(fmt::format("layers.{}.{}", k, what));
  }

  const LayersReport& report;
  const nn::Trace& trace;
};

std::size_t layer_count(const nn::Trace& trace) {
  std::size_t count = 0;
  while (trace.has(fmt::format("layers.{}.z", count))) ++count;
  return count;
}

/// "-0.51 to 2.3"; no zero has a sign.
std::string range_text(std::span<const float> values) {
  const auto [smallest, largest] = std::ranges::minmax(values);
  return fmt::format("{:.4g} to {:.4g}", smallest + 0.0F, largest + 0.0F);
}

/// One channel of a tensor without a unit, black its smallest value, white its largest: beside a
/// channel of large values one of small ones would be grey all over.
void add_channel(LayersPage& page, const nn::TracedTensor& tensor, int channel) {
  const auto pixels = static_cast<std::size_t>(tensor.rows()) * tensor.columns();
  const std::span<const float> values = tensor.all().subspan(channel * pixels, pixels);
  const auto [smallest, largest] = std::ranges::minmax(values);
  std::vector<float> shares;
  for (const float value : values) {
    shares.push_back(largest > smallest ? (value - smallest) / (largest - smallest) : 0.0F);
  }
  page.picture(share_image(shares, tensor.rows(), tensor.columns()),
               fmt::format("{}, channel {}: {}", tensor.name, channel, range_text(values)));
}

/// The tensors that were asked for, channel by channel.
void add_named(LayersPage& page) {
  for (const std::string& name : page.report.tensors) {
    const nn::TracedTensor& tensor = page.trace.tensor(name);
    const bool metres = tensor.unit == "m";
    page.heading(2, name);
    page.paragraph(fmt::format(
        "{} channels of {} x {}, {}{}", tensor.channels(), tensor.rows(), tensor.columns(),
        range_text(tensor.all()),
        metres ? " m" : "; of each channel black the smallest value, white the largest"));
    if (metres) {
      page.ranges(page.trace.image(name), name);
      continue;
    }
    for (int channel = 0; channel < tensor.channels(); ++channel) add_channel(page, tensor, channel);
  }
}

/// How far every tensor is from the reference in double precision.
void add_differences(LayersPage& page) {
  if (page.report.differences.empty()) return;
  page.heading(2, "Difference from the reference");
  page.paragraph(
      "The same network in plain loops and double precision, with the same decisions of the "
      "filter. Where two modes are equally likely a rounding decides between them.");
  TextTable table{.columns = {"tensor", "largest", "root mean square"}};
  for (const nn::ReferenceDifference& difference : page.report.differences) {
    const auto text = [&](double value) {
      return fmt::format("{:.3g} {}", value, difference.unit);
    };
    table.rows.push_back(
        {difference.name, text(difference.largest), text(difference.root_mean_square)});
  }
  page.table(table);
}

/// A layer of two modes and the probability of a return.
void add_mixture(LayersPage& page, std::size_t k) {
  const RangeImage z = page.image_of(k, "z");
  RangeImage likely = z;
  const std::vector<float> probability = page.trace.image("probability").range_m;
  for (std::size_t i = 0; i < probability.size(); ++i) {
    if (probability[i] < 0.5F) likely.range_m[i] = 0.0F;
  }
  page.ranges(page.image_of(k, "h"), "H: what was measured, and what is known of the rest so far");
  page.ranges(page.trace.image("mode_1"), "Mode 1, on the side of the measured row above");
  page.ranges(page.trace.image("mode_2"), "Mode 2, on the side of the row below");
  page.picture(share_image(page.trace.image("weight_1").range_m, z.rows, z.columns),
               "Weight of mode 1: white certain, black none");
  page.ranges(z, "Z: the likelier of the two modes");
  page.picture(share_image(probability, z.rows, z.columns),
               "Probability of a return: white certain, black none");
  page.ranges(likely, "Z where a return is likely");
}

/// M and W^2 / (W^2 + 1), the share of H that memory has where its mode does not scale it.
void add_recalled(LayersPage& page) {
  const RangeImage recalled = page.trace.image("recalled");
  std::vector<float> share = page.trace.image("recalled_weight").range_m;
  for (float& weight : share) weight /= weight + 1.0F;
  page.ranges(recalled, "M: what other scans measured, seen from here");
  page.picture(share_image(share, recalled.rows, recalled.columns),
               "W² / (W² + 1): white memory alone, black nothing is recalled");
}

void add_without_memory(LayersPage& page) {
  page.ranges(*page.report.without_memory, "Result without a memory");
  page.picture(decided_image(page.report),
               page.report.truth
                   ? "Where memory changed a range by more than 0.1 m: green nearer to "
                     "the truth, red farther, orange where the truth has no return"
                   : "Where memory changed a range by more than 0.1 m: orange");
}

/// A network that says all ranges in one go.
void add_direct(LayersPage& page) {
  const RangeImage said = page.image_of(0, "z");
  page.heading(2, "The network");
  page.ranges(said, "What it says of every pixel");
  page.mask(said, "layers.0.rejected", "Pixels on which its passes with dropout disagree, in red");
  page.ranges(page.image_of(0, "y"), "What remains");
}

void add_layer(LayersPage& page, std::size_t k) {
  const std::string heading = fmt::format("Layer {} (layers.{})", k + 1, k);
  if (page.trace.has("probability")) {
    page.heading(2, heading);
    return add_mixture(page, k);
  }
  if (!page.trace.has("layers.0.h")) return add_direct(page);
  const nn::ObjectiveTerms terms =
      objective_terms(page.trace, static_cast<int>(k), page.report.network.measured_rows);
  const float penalty = page.trace.tensor(fmt::format("layers.{}.penalty", k)).values(0, 0, 0);
  page.heading(2, fmt::format("{}, b = {:.3f}", heading, penalty));
  page.paragraph(
      fmt::format("data {:.2f} m², denoiser gap {:.0f} m², filter gap {:.1f} m², {} pixels "
                  "rejected (terms of eq. 5)",
                  terms.data_m2, terms.denoiser_gap_m2, terms.filter_gap_m2, terms.rejected));
  const RangeImage h = page.image_of(k, "h");
  const RangeImage z = page.image_of(k, "z");
  page.ranges(h, "H: data consistency (eq. 10a)");
  page.ranges(z, "Z: denoiser (eq. 10b)");
  if (const std::string rejected = fmt::format("layers.{}.rejected", k); page.trace.has(rejected)) {
    page.mask(h, rejected, "Q of H: rejected pixels in red");
    page.ranges(page.image_of(k, "y"), "Y (eq. 10c): H, where it was rejected Z");
  }
  if (page.report.truth) {
    page.error(z, fmt::format("Z against the truth, mean error {:.2f} m",
                              image_error(z, *page.report.truth).mae_all_m));
  }
}

void add_result(LayersPage& page) {
  page.heading(2, "Result");
  const RangeImage& result = page.report.result;
  if (!page.report.confidence.empty()) {
    page.picture(
        share_image(page.report.confidence, result.rows, result.columns),
        fmt::format("Confidence: a return, and within {} m of its range. White certain; "
                    "emptied below {:.2f}",
                    nn::SuperResolverOptions{}.tolerance_m, page.report.network.least_confidence));
    page.ranges(result, "Result: measured rows, doubtful pixels empty");
    if (page.report.truth) {
      page.error(
          result,
          fmt::format("Result against the truth, mean error {:.2f} m where both have a return",
                      image_error(result, *page.report.truth).mae_valid_m));
    }
  } else {
    if (last_filter(page.report.network)) {
      page.mask(page.image_of(layer_count(page.trace) - 1, "z"), "rejected",
                "Q of the last Z: rejected pixels in red");
    }
    page.ranges(result, "Result: measured rows restored, rejected pixels empty");
  }
  if (page.report.without_memory) add_without_memory(page);
  if (page.report.truth) page.ranges(*page.report.truth, "Truth");
}

}  // namespace

std::string layers_html(const LayersReport& report) {
  LayersPage page(report);
  page.style("\nfigure img { height: 8rem; image-rendering: pixelated; }\n");
  page.head_html(kLayersPageMarker);
  page.heading(1, fmt::format("Scan {}, layer by layer", report.scan));
  page.paragraph(
      fmt::format("{}, upsampled by {}. Bright is near, dark blue far, black without a return.",
                  report.recording, report.weights));
  add_named(page);
  add_differences(page);
  page.ranges(report.measured, "Measured rows (L)");
  if (page.trace.has("start"))
    page.ranges(page.trace.image("start"), "Start (Z and Y before layer 1)");
  if (page.trace.has("recalled")) add_recalled(page);
  for (std::size_t k = 0; k < layer_count(page.trace); ++k) add_layer(page, k);
  add_result(page);
  return page.text();
}

}  // namespace hqslam::tools
