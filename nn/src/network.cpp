#include "hqslam/nn/network.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>

#include "architecture.h"
#include "hqslam/core/error.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

void require_available(InstructionSet instruction_set) {
  const std::vector<InstructionSet> available = available_instruction_sets();
  if (std::ranges::find(available, instruction_set) != available.end()) return;
  std::vector<std::string_view> names;
  for (const InstructionSet one : available) names.push_back(name(one));
  throw Error(
      "network: instruction set number {}, expected one that this processor and build have: {}",
      static_cast<int>(instruction_set), fmt::join(names, ", "));
}

void check_image(const RangeImage& image, const char* what, int rows, int columns) {
  const auto pixels = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  if (image.rows != rows || image.columns != columns || image.range_m.size() != pixels) {
    throw Error("network: {} of {} x {} with {} ranges, expected {} x {}", what, image.rows,
                image.columns, image.range_m.size(), rows, columns);
  }
}

}  // namespace

Network::Network(const NetworkDescription& description, int columns)
    : measured_rows_(select_rows(description.sensor, description.measured_rows).rows()),
      rows_(description.sensor.rows()),
      columns_(columns),
      parameters_(elements(parameter_shapes(description))) {}

void Network::check(const Observation& seen) const {
  check_image(seen.measured, "measured rows", measured_rows_, columns_);
  if (seen.recalled == nullptr || seen.recalled->is_empty()) return;
  check_image(seen.recalled->image, "recalled ranges", rows_, columns_);
  if (seen.recalled->weight.size() != seen.recalled->image.range_m.size()) {
    throw Error("network: {} weights of what is recalled, expected one for each of {} pixels",
                seen.recalled->weight.size(), seen.recalled->image.range_m.size());
  }
}

double Network::add_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                              std::span<const std::uint64_t> seeds, std::span<float> d_parameters) {
  for (const TrainingSample& sample : batch) {
    check({sample.measured, sample.recalled});
    check_image(sample.truth, "true ranges", rows_, columns_);
  }
  if (seeds.size() != batch.size() || std::ssize(d_parameters) != parameters_) {
    throw Error(
        "network: {} seeds for {} scans and a gradient of {} values, expected a seed for each scan "
        "and {} values",
        seeds.size(), batch.size(), d_parameters.size(), parameters_);
  }
  // In a team of its own what the threads of a team share is all done, whoever calls.
  double loss = 0.0;
  std::exception_ptr thrown;
#pragma omp parallel num_threads(1)
  try {
    loss = batch_gradients(batch, options, seeds, d_parameters);
  } catch (...) {
    thrown = std::current_exception();
  }
  if (thrown != nullptr) std::rethrow_exception(thrown);
  return loss;
}

std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads) {
  constexpr int kMostThreads = 1024;
  require_available(instruction_set);
  check_field("threads", threads, 1, kMostThreads);
  validate(description);
  check_columns(description, columns);
  return description.architecture->make_network(description, columns, instruction_set, threads);
}

}  // namespace hqslam::nn
