#include "hqslam/nn/trace.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

double squared_gap(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double gap = a[i] - b[i];
    sum += gap * gap;
  }
  return sum;
}

}  // namespace

const TracedTensor* Trace::find(std::string_view name) const {
  const auto found = std::ranges::find(tensors_, name, &TracedTensor::name);
  return found == tensors_.end() ? nullptr : &*found;
}

const TracedTensor& Trace::tensor(std::string_view name) const {
  if (const TracedTensor* found = find(name)) return *found;
  std::vector<std::string_view> names;
  for (const TracedTensor& tensor : tensors_) names.push_back(tensor.name);
  throw Error("trace: no tensor '{}', expected one of {}", name, fmt::join(names, ", "));
}

RangeImage Trace::image(std::string_view name) const {
  const TracedTensor& from = tensor(name);
  if (from.channels != 1) {
    throw Error("trace: '{}' has {} channels, expected 1 of an image", name, from.channels);
  }
  RangeImage image(from.rows, from.columns);
  image.range_m = from.values;
  return image;
}

TracedTensor traced_image(std::string name, RangeImage image, std::string unit) {
  return {std::move(name), std::move(unit), 1, image.rows, image.columns, std::move(image.range_m)};
}

ObjectiveTerms objective_terms(const Trace& trace, int k, RowSelection measured_rows) {
  const auto of_layer = [&](const char* what) { return fmt::format("layers.{}.{}", k, what); };
  const TracedTensor& h = trace.tensor(of_layer("h"));
  const double penalty = trace.tensor(of_layer("penalty")).values.front();
  const RangeImage kept = select_rows(trace.image(h.name), measured_rows);
  ObjectiveTerms terms;
  terms.data_m2 = 0.5 * squared_gap(trace.tensor("measured").values, kept.range_m);
  terms.denoiser_gap_m2 = 0.5 * penalty * squared_gap(trace.tensor(of_layer("z")).values, h.values);
  if (!trace.has(of_layer("y"))) return terms;
  terms.filter_gap_m2 = 0.5 * penalty * squared_gap(trace.tensor(of_layer("y")).values, h.values);
  const std::vector<float>& rejected = trace.tensor(of_layer("rejected")).values;
  terms.rejected = std::ranges::count(rejected, 1.0F);
  return terms;
}

}  // namespace hqslam::nn
