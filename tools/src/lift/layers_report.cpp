#include "lift/layers_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "hqslam/evaluation/image_error.h"
#include "hqslam/evaluation/png.h"
#include "report/chart.h"
#include "report/cloud_picture.h"
#include "report/page.h"

namespace hqslam::tools {
namespace {

using Pixel = std::array<std::uint8_t, 3>;

constexpr Pixel kRejected = {235, 60, 50};

std::string image_html(const RgbImage& image, const std::string& caption) {
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption>"
      "</figure>\n",
      escape_html(caption), base64(encode_png(image)));
}

std::string range_html(const RangeImage& image, const LayersReport& report,
                       const std::string& caption) {
  RangeImage seen = image;
  for (float& range_m : seen.range_m) {
    if (!(range_m >= report.min_range_m)) range_m = 0.0F;
  }
  return image_html(color_by_range(seen, report.max_range_m), caption);
}

/// Grey where the filter keeps a pixel, red where it rejects it, black without a return.
RgbImage mask_image(const RangeImage& filtered, double min_range_m,
                    const std::vector<float>& rejected) {
  RgbImage image{filtered.rows, filtered.columns, {}};
  for (std::size_t i = 0; i < filtered.range_m.size(); ++i) {
    const std::uint8_t grey = filtered.range_m[i] >= min_range_m ? 150 : 0;
    image.pixels.push_back(rejected[i] != 0.0F ? kRejected : Pixel{grey, grey, grey});
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

std::size_t layer_count(const LayersReport& report) {
  std::size_t count = 0;
  while (report.trace.has(fmt::format("layers.{}.z", count))) ++count;
  return count;
}

/// One channel of a tensor without a unit, black its smallest value, white its largest: beside a
/// channel of large values one of small ones would be grey all over.
std::string channel_html(const nn::TracedTensor& tensor, int channel) {
  const auto pixels = static_cast<std::size_t>(tensor.rows) * tensor.columns;
  const std::span<const float> values = std::span(tensor.values).subspan(channel * pixels, pixels);
  const auto [smallest, largest] = std::ranges::minmax(values);
  std::vector<float> shares;
  for (const float value : values) {
    shares.push_back(largest > smallest ? (value - smallest) / (largest - smallest) : 0.0F);
  }
  return image_html(
      share_image(shares, tensor.rows, tensor.columns),
      fmt::format("{}, channel {}: {:.4g} to {:.4g}", tensor.name, channel, smallest, largest));
}

/// The tensors that were asked for, channel by channel.
std::string named_html(const LayersReport& report) {
  std::string html;
  for (const std::string& name : report.tensors) {
    const nn::TracedTensor& tensor = report.trace.tensor(name);
    const auto [smallest, largest] = std::ranges::minmax(tensor.values);
    const bool metres = tensor.unit == "m";
    html += fmt::format(
        "<h2>{}</h2>\n<p class=\"quiet\">{} channels of {} x {}, {:.4g} to {:.4g}{}</p>\n",
        escape_html(name), tensor.channels, tensor.rows, tensor.columns, smallest, largest,
        metres ? " m" : "; of each channel black the smallest value, white the largest");
    if (metres) {
      html += range_html(report.trace.image(name), report, name);
      continue;
    }
    for (int channel = 0; channel < tensor.channels; ++channel) {
      html += channel_html(tensor, channel);
    }
  }
  return html;
}

/// How far every tensor is from the reference in double precision.
std::string differences_html(const LayersReport& report) {
  if (report.differences.empty()) return "";
  std::string html =
      "<h2>Difference from the reference</h2>\n<p class=\"quiet\">The same network in plain loops "
      "and double precision, with the same decisions of the filter. Where two modes are equally "
      "likely a rounding decides between them.</p>\n<table><tr><th>tensor</th><th>largest</th>"
      "<th>root mean square</th></tr>\n";
  for (const nn::ReferenceDifference& difference : report.differences) {
    html += fmt::format("<tr><td>{}</td><td>{:.3g} {}</td><td>{:.3g} {}</td></tr>\n",
                        escape_html(difference.name), difference.largest, difference.unit,
                        difference.root_mean_square, difference.unit);
  }
  return html + "</table>\n";
}

/// The image of a layer's tensor.
RangeImage image_of(const LayersReport& report, std::size_t k, const char* what) {
  return report.trace.image(fmt::format("layers.{}.{}", k, what));
}

std::string mask_html(const LayersReport& report, const RangeImage& filtered,
                      const std::string& mask, const std::string& caption) {
  return image_html(mask_image(filtered, report.min_range_m, report.trace.tensor(mask).values),
                    caption);
}

/// A layer of two modes and the probability of a return.
std::string mixture_html(const LayersReport& report, std::size_t k) {
  RangeImage likely = image_of(report, k, "z");
  const std::vector<float>& probability = report.trace.tensor("probability").values;
  for (std::size_t i = 0; i < probability.size(); ++i) {
    if (probability[i] < 0.5F) likely.range_m[i] = 0.0F;
  }
  return range_html(image_of(report, k, "h"), report,
                    "H: what was measured, and what is known of the rest so far") +
         range_html(report.trace.image("mode_1"), report,
                    "Mode 1, on the side of the measured row above") +
         range_html(report.trace.image("mode_2"), report, "Mode 2, on the side of the row below") +
         image_html(
             share_image(report.trace.tensor("weight_1").values, likely.rows, likely.columns),
             "Weight of mode 1: white certain, black none") +
         range_html(image_of(report, k, "z"), report, "Z: the likelier of the two modes") +
         image_html(share_image(probability, likely.rows, likely.columns),
                    "Probability of a return: white certain, black none") +
         range_html(likely, report, "Z where a return is likely");
}

/// M and W^2 / (W^2 + 1), the share of H that memory has where its mode does not scale it.
std::string recalled_html(const LayersReport& report) {
  if (!report.trace.has("recalled")) return "";
  const RangeImage recalled = report.trace.image("recalled");
  std::vector<float> share = report.trace.tensor("recalled_weight").values;
  for (float& weight : share) weight /= weight + 1.0F;
  return range_html(recalled, report, "M: what earlier scans measured, seen from here") +
         image_html(share_image(share, recalled.rows, recalled.columns),
                    "W² / (W² + 1): white memory alone, black nothing is recalled");
}

/// Where the result is another than without a memory, by more than 0.1 m: of the truth's returns
/// whether it came nearer (green) or went away (red), of the others, or all, orange.
RgbImage decided_image(const LayersReport& report) {
  constexpr Pixel kNearer = {40, 190, 90};
  constexpr Pixel kChanged = {245, 160, 40};
  constexpr float kSame_m = 0.1F;
  RgbImage image{report.result.rows, report.result.columns, {}};
  for (std::size_t i = 0; i < report.result.range_m.size(); ++i) {
    const float with_m = report.result.range_m[i];
    const float without_m = report.without_memory->range_m[i];
    const float truth_m = report.truth ? report.truth->range_m[i] : 0.0F;
    const std::uint8_t grey = with_m > 0.0F ? 90 : 0;
    Pixel colour = {grey, grey, grey};
    if (std::abs(with_m - without_m) > kSame_m) {
      const bool nearer = std::abs(with_m - truth_m) < std::abs(without_m - truth_m);
      colour = truth_m == 0.0F ? kChanged : nearer ? kNearer : kRejected;
    }
    image.pixels.push_back(colour);
  }
  return image;
}

std::string without_memory_html(const LayersReport& report) {
  if (!report.without_memory) return "";
  return range_html(*report.without_memory, report, "Result without a memory") +
         image_html(decided_image(report),
                    report.truth ? "Where memory changed a range by more than 0.1 m: green nearer "
                                   "to the truth, red farther, orange where the truth has no return"
                                 : "Where memory changed a range by more than 0.1 m: orange");
}

/// A network that says all ranges in one go.
std::string direct_html(const LayersReport& report) {
  const RangeImage said = image_of(report, 0, "z");
  return "<h2>The network</h2>\n" + range_html(said, report, "What it says of every pixel") +
         mask_html(report, said, "layers.0.rejected",
                   "Pixels on which its passes with dropout disagree, in red") +
         range_html(image_of(report, 0, "y"), report, "What remains");
}

std::string layer_html(const LayersReport& report, std::size_t k) {
  const std::string heading = fmt::format("<h2>Layer {}", k + 1);
  if (report.trace.has("probability")) {
    return fmt::format("{}</h2>\n{}", heading, mixture_html(report, k));
  }
  if (!report.trace.has("layers.0.h")) return direct_html(report);
  const nn::ObjectiveTerms terms =
      objective_terms(report.trace, static_cast<int>(k), report.network.measured_rows);
  std::string html =
      heading + fmt::format(
                    ", b = {:.3f}</h2>\n<p class=\"quiet\">data {:.2f} m², denoiser gap {:.0f} m², "
                    "filter gap {:.1f} m², {} pixels rejected (terms of eq. 5)</p>\n",
                    report.trace.tensor(fmt::format("layers.{}.penalty", k)).values.front(),
                    terms.data_m2, terms.denoiser_gap_m2, terms.filter_gap_m2, terms.rejected);
  const RangeImage h = image_of(report, k, "h");
  const RangeImage z = image_of(report, k, "z");
  html += range_html(h, report, "H: data consistency (eq. 10a)");
  html += range_html(z, report, "Z: denoiser (eq. 10b)");
  const std::string rejected = fmt::format("layers.{}.rejected", k);
  if (report.trace.has(rejected)) {
    html += mask_html(report, h, rejected, "Q of H: rejected pixels in red") +
            range_html(image_of(report, k, "y"), report, "Y (eq. 10c): H, where it was rejected Z");
  }
  if (report.truth) {
    html +=
        image_html(error_image(z, *report.truth),
                   fmt::format("Z against the truth, mean error {:.2f} m: white 0.1 m and less, "
                               "dark red 10 m and more",
                               image_error(z, *report.truth).mae_all_m));
  }
  return html;
}

std::string result_html(const LayersReport& report) {
  std::string html = "<h2>Result</h2>\n";
  if (!report.confidence.empty()) {
    const std::string caption = fmt::format(
        "Confidence: a return, and within {} m of its range. White certain; emptied "
        "below {:.2f}",
        nn::SuperResolverOptions{}.tolerance_m, report.network.least_confidence);
    html += image_html(share_image(report.confidence, report.result.rows, report.result.columns),
                       caption);
    html += range_html(report.result, report, "Result: measured rows, doubtful pixels empty");
    if (report.truth) {
      html +=
          image_html(error_image(report.result, *report.truth),
                     fmt::format("Result against the truth, mean error {:.2f} m where both have "
                                 "a return: white 0.1 m and less, dark red 10 m and more",
                                 image_error(report.result, *report.truth).mae_valid_m));
    }
  } else {
    if (last_filter(report.network)) {
      html += mask_html(report, image_of(report, layer_count(report) - 1, "z"), "rejected",
                        "Q of the last Z: rejected pixels in red");
    }
    html +=
        range_html(report.result, report, "Result: measured rows restored, rejected pixels empty");
  }
  html += without_memory_html(report);
  if (report.truth) html += range_html(*report.truth, report, "Truth");
  return html;
}

}  // namespace

std::string layers_html(const LayersReport& report) {
  constexpr const char* kStyle =
      "\nfigure { margin: .75rem 0; }\nfigure img { width: 100%; height: 8rem; display: block; "
      "image-rendering: pixelated; }\nfigcaption { color: var(--quiet); font-size: .85rem; }\n";
  std::string html = fmt::format(
      "<h1>Scan {}, layer by layer</h1>\n<p class=\"quiet\">{}, lifted by {}. Bright is near, dark "
      "blue far, black without a return.</p>\n",
      report.scan, escape_html(report.recording), escape_html(report.weights));
  html += named_html(report);
  html += differences_html(report);
  html += range_html(report.measured, report, "Measured rows (L)");
  if (report.trace.has("start")) {
    html += range_html(report.trace.image("start"), report, "Start (Z and Y before layer 1)");
  }
  html += recalled_html(report);
  for (std::size_t k = 0; k < layer_count(report); ++k) html += layer_html(report, k);
  html += result_html(report);
  return page_html(fmt::format("Layers of scan {}", report.scan), kStyle, html,
                   fmt::format("{}\n", kLayersPageMarker));
}

}  // namespace hqslam::tools
