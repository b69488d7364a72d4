#include "lift/layers_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/evaluation/image_error.h"
#include "hqslam/evaluation/png.h"
#include "report/chart.h"
#include "report/density_image.h"
#include "report/report_style.h"

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
                    const std::vector<std::uint8_t>& rejected) {
  RgbImage image{filtered.rows, filtered.columns, {}};
  for (std::size_t i = 0; i < filtered.range_m.size(); ++i) {
    const std::uint8_t grey = filtered.range_m[i] >= min_range_m ? 150 : 0;
    image.pixels.push_back(rejected[i] != 0 ? kRejected : Pixel{grey, grey, grey});
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

/// What the filter looks at, what it rejects, and what becomes of it.
std::string filter_html(const LayersReport& report, const nn::LayerTrace& layer) {
  const bool of_h = layer.filtered == nn::FilteredIterate::kH;
  const char* const filtered = of_h ? "H" : "Z";
  const char* const taken = layer.rejected_pixel == nn::RejectedPixel::kTakesZ ? "Z" : "0";
  return image_html(mask_image(of_h ? layer.h : layer.z, report.min_range_m, layer.rejected),
                    fmt::format("Q of {}: rejected pixels in red", filtered)) +
         range_html(layer.y, report,
                    fmt::format("Y (eq. 10c): {}, where it was rejected {}", filtered, taken));
}

/// A layer of two modes and the probability of a return.
std::string mixture_html(const LayersReport& report, const nn::LayerTrace& layer) {
  return range_html(layer.h, report, "H: what was measured, and what is known of the rest so far") +
         range_html(layer.z, report, "Z: the likelier of the two modes of every pixel") +
         image_html(share_image(layer.probability, layer.z.rows, layer.z.columns),
                    "Probability of a return: white certain, black none") +
         range_html(layer.y, report, "Z where a return is likely");
}

/// A network that says all ranges in one go.
std::string direct_html(const LayersReport& report, const nn::LayerTrace& layer) {
  return "<h2>The network</h2>\n" + range_html(layer.z, report, "What it says of every pixel") +
         image_html(mask_image(layer.z, report.min_range_m, layer.rejected),
                    "Pixels on which its passes with dropout disagree, in red") +
         range_html(layer.y, report, "What remains");
}

std::string layer_html(const LayersReport& report, std::size_t index) {
  const nn::LayerTrace& layer = report.trace.layers[index];
  if (layer.h.range_m.empty()) return direct_html(report, layer);
  if (!layer.probability.empty()) {
    return fmt::format("<h2>Layer {}</h2>\n", index + 1) + mixture_html(report, layer);
  }
  std::string html = fmt::format(
      "<h2>Layer {}, b = {:.3f}</h2>\n<p class=\"quiet\">data {:.2f} m², denoiser gap {:.0f} m², "
      "filter gap {:.1f} m², {} pixels rejected (terms of eq. 5)</p>\n",
      index + 1, layer.penalty, layer.objective.data_m2, layer.objective.denoiser_gap_m2,
      layer.objective.filter_gap_m2, layer.objective.rejected);
  html += range_html(layer.h, report, "H: data consistency (eq. 10a)");
  html += range_html(layer.z, report, "Z: denoiser (eq. 10b)");
  if (!layer.rejected.empty()) html += filter_html(report, layer);
  if (report.truth) {
    html +=
        image_html(error_image(layer.z, *report.truth),
                   fmt::format("Z against the truth, mean error {:.2f} m: white 0.1 m and less, "
                               "dark red 10 m and more",
                               image_error(layer.z, *report.truth).mae_all_m));
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
      html += image_html(
          mask_image(report.trace.layers.back().z, report.min_range_m, report.trace.rejected),
          "Q of the last Z: rejected pixels in red");
    }
    html +=
        range_html(report.result, report, "Result: measured rows restored, rejected pixels empty");
  }
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
  html += range_html(report.measured, report, "Measured rows (L)");
  if (!report.trace.start.range_m.empty()) {
    html += range_html(report.trace.start, report, "Start (Z and Y before layer 1)");
  }
  for (std::size_t layer = 0; layer < report.trace.layers.size(); ++layer) {
    html += layer_html(report, layer);
  }
  return page_html(fmt::format("Layers of scan {}", report.scan), kStyle,
                   html + result_html(report), fmt::format("{}\n", kLayersPageMarker));
}

}  // namespace hqslam::tools
