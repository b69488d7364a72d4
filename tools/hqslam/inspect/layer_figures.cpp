#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "hqslam/evaluation/image_error.h"
#include "inspect/layers_report.h"

namespace hqslam::tools {
namespace {

double rms(std::span<const float> a, std::span<const float> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double gap = static_cast<double>(a[i]) - b[i];
    sum += gap * gap;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, a.size())));
}

std::int64_t count_of(const nn::TracedTensor& mask) {
  return std::ranges::count_if(mask.all(), [](float value) { return value != 0.0F; });
}

/// The image with its measured rows as they were measured.
RangeImage restored(RangeImage image, const LayersReport& report) {
  const RowSelection rows = report.network.measured_rows;
  for (int row = 0; row < report.measured.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      image.at(rows.offset + row * rows.stride, column) = report.measured.at(row, column);
    }
  }
  return image;
}

/// wrong_share and missing_share.
void count_computed(const LayersReport& report, const RangeImage& image, LayerFigures& figures) {
  std::int64_t returns = 0;
  std::int64_t wrong = 0;
  std::int64_t of_truth = 0;
  std::int64_t missing = 0;
  const double nearest_m = report.network.sensor.min_range_m;
  for (int row = 0; row < image.rows; ++row) {
    if (report.network.measured_rows.contains(row)) continue;
    for (int column = 0; column < image.columns; ++column) {
      const float range_m = image.at(row, column);
      const float true_m = report.truth->at(row, column);
      const bool is_return = range_m >= nearest_m;
      returns += is_return ? 1 : 0;
      wrong += is_return && (true_m == 0.0F || std::abs(range_m - true_m) > kWrong_m) ? 1 : 0;
      of_truth += true_m > 0.0F ? 1 : 0;
      missing += true_m > 0.0F && !is_return ? 1 : 0;
    }
  }
  const auto share = [](std::int64_t some, std::int64_t all) {
    return static_cast<double>(some) / static_cast<double>(std::max<std::int64_t>(1, all));
  };
  figures.wrong_share = share(wrong, returns);
  figures.missing_share = share(missing, of_truth);
}

void add_error(const LayersReport& report, const RangeImage& image, LayerFigures& figures) {
  if (!report.truth) return;
  const ImageError error = image_error(restored(image, report), *report.truth);
  figures.error_all_m = error.mae_all_m;
  figures.error_valid_m = error.mae_valid_m;
  count_computed(report, image, figures);
}

LayerFigures figures_of_layer(const LayersReport& report, int k) {
  const nn::Trace& trace = report.trace;
  LayerFigures figures;
  figures.name = fmt::format("Layer {}", k + 1);
  const auto tensor = [&](const char* what) -> const nn::TracedTensor* {
    const std::string name = layer_name(k, what);
    return trace.has(name) ? &trace.tensor(name) : nullptr;
  };
  if (const auto* penalty = tensor("penalty")) figures.penalty = penalty->all().front();
  if (const auto* h = tensor("h")) {
    figures.rms_h_z_m = rms(h->all(), tensor("z")->all());
    if (const auto* y = tensor("y")) figures.rms_h_y_m = rms(h->all(), y->all());
    const RangeImage kept = select_rows(trace.image(h->name), report.network.measured_rows);
    figures.rms_dh_l_m = rms(kept.range_m, trace.tensor("measured").all());
  }
  if (const auto* rejected = tensor("rejected")) figures.rejected = count_of(*rejected);
  add_error(report, trace.image(layer_name(k, "z")), figures);
  return figures;
}

}  // namespace

std::string layer_name(int k, const char* what) { return fmt::format("layers.{}.{}", k, what); }

int layer_count(const nn::Trace& trace) {
  int count = 0;
  while (trace.has(layer_name(count, "z"))) ++count;
  return count;
}

bool has_last_filter(const LayersReport& report) {
  return report.confidence.empty() && nn::last_filter(report.network);
}

std::vector<LayerFigures> layer_figures(const LayersReport& report) {
  std::vector<LayerFigures> all;
  for (int k = 0; k < layer_count(report.trace); ++k) all.push_back(figures_of_layer(report, k));
  LayerFigures& result = all.emplace_back();
  result.name = "Result";
  if (!report.confidence.empty()) {
    result.rejected = std::ranges::count_if(report.confidence, [&](float confidence) {
      return confidence < report.network.least_confidence;
    });
  } else if (has_last_filter(report)) {
    result.rejected = count_of(report.trace.tensor("rejected"));
  }
  add_error(report, report.result, result);
  for (const Variant& variant : report.variants) {
    LayerFigures& changed = all.emplace_back();
    changed.name = fmt::format("Result, {}", variant.change);
    add_error(report, variant.result, changed);
  }
  return all;
}

}  // namespace hqslam::tools
