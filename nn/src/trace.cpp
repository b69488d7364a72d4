#include "hqslam/nn/trace.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

double squared_gap(std::span<const float> a, std::span<const float> b) {
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
  if (from.channels() != 1) {
    throw Error("trace: '{}' has {} channels, expected 1 of an image", name, from.channels());
  }
  RangeImage image(from.rows(), from.columns());
  std::ranges::copy(from.all(), image.range_m.begin());
  return image;
}

TracedTensor traced_image(std::string name, const RangeImage& image, std::string unit) {
  TracedTensor::Values values(1, image.rows, image.columns);
  std::ranges::copy(image.range_m, values.data());
  return {std::move(name), std::move(unit), std::move(values)};
}

ObjectiveTerms objective_terms(const Trace& trace, int k, RowSelection measured_rows) {
  const auto of_layer = [&](const char* what) { return fmt::format("layers.{}.{}", k, what); };
  const TracedTensor& h = trace.tensor(of_layer("h"));
  const double penalty = trace.tensor(of_layer("penalty")).values(0, 0, 0);
  const RangeImage kept = select_rows(trace.image(h.name), measured_rows);
  ObjectiveTerms terms;
  terms.data_m2 = 0.5 * squared_gap(trace.tensor("measured").all(), kept.range_m);
  terms.denoiser_gap_m2 = 0.5 * penalty * squared_gap(trace.tensor(of_layer("z")).all(), h.all());
  if (!trace.has(of_layer("y"))) return terms;
  terms.filter_gap_m2 = 0.5 * penalty * squared_gap(trace.tensor(of_layer("y")).all(), h.all());
  terms.rejected = std::ranges::count(trace.tensor(of_layer("rejected")).all(), 1.0F);
  return terms;
}

}  // namespace hqslam::nn
