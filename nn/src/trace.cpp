#include "hqslam/nn/trace.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hqslam/core/error.h"
#include "hqslam/core/nearest_names.h"

namespace hqslam::nn {

const TracedTensor* Trace::find(std::string_view name) const {
  const auto found = std::ranges::find(tensors_, name, &TracedTensor::name);
  return found == tensors_.end() ? nullptr : &*found;
}

const TracedTensor& Trace::tensor(std::string_view name) const {
  if (const TracedTensor* found = find(name)) return *found;
  std::vector<std::string> names;
  for (const TracedTensor& tensor : tensors_) names.push_back(tensor.name);
  const std::string near = did_you_mean(name, names);
  throw Error("trace: no tensor '{}' among {}{}", name, names.size(),
              near.empty() ? "; names are such as 'layers.0.z' (trace.h)" : near);
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

}  // namespace hqslam::nn
