#include "bench/bench_network.h"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "bench/network_steps.h"
#include "hqslam/nn/conv2d.h"
#include "hqslam/nn/conv_transpose2d.h"
#include "hqslam/nn/hqs/data_consistency.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "hqslam/nn/hqs/selection.h"
#include "hqslam/nn/hqs/super_resolver.h"
#include "hqslam/nn/multiply_add_peak.h"

namespace hqslam::tools {
namespace {

using Clock = std::chrono::steady_clock;
using nn::Tensor;

constexpr double kRunTime_s = 1.0;  ///< of a network with one instruction set and thread count
constexpr int kFewestFrames = 3;    ///< however long they take
constexpr int kMostFrames = 300;
constexpr double kStepTime_s = 0.1;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::vector<RangeImage> measured_rows_of(const nn::Weights& weights,
                                         const std::vector<RangeImage>& images) {
  std::vector<RangeImage> measured;
  for (const RangeImage& image : images) {
    measured.push_back(select_rows(image, weights.description.measured_rows));
  }
  return measured;
}

double peak_of(const std::vector<MultiplyAddPeak>& peaks, nn::InstructionSet instruction_set,
               int threads) {
  for (const MultiplyAddPeak& peak : peaks) {
    if (peak.instruction_set == instruction_set && peak.threads == threads) {
      return peak.gflops;
    }
  }
  return 0.0;
}

NetworkRun time_run(const nn::Weights& weights, const std::vector<RangeImage>& measured,
                    nn::InstructionSet instruction_set, int threads,
                    const std::vector<MultiplyAddPeak>& peaks, const InterruptGuard& interrupt) {
  nn::SuperResolverOptions options;
  options.threads = threads;
  options.instruction_set = instruction_set;
  nn::SuperResolver resolver(weights, options);
  resolver.run(measured.front());
  std::vector<double> times_ms;
  const auto start = Clock::now();
  for (int i = 0; i < kMostFrames && !interrupt.stop_requested(); ++i) {
    if (i >= kFewestFrames && milliseconds_since(start) > 1e3 * kRunTime_s) {
      break;
    }
    const auto frame_start = Clock::now();
    resolver.run(measured[i % measured.size()]);
    times_ms.push_back(milliseconds_since(frame_start));
  }
  NetworkRun run;
  run.instruction_set = instruction_set;
  run.threads = threads;
  run.frames = static_cast<int>(times_ms.size());
  run.frame_ms = distribution_of(std::move(times_ms));
  const double peak = peak_of(peaks, instruction_set, threads);
  run.gflops = run.frame_ms.median > 0.0
                   ? 2e-6 * static_cast<double>(resolver.multiply_adds()) / run.frame_ms.median
                   : 0.0;
  run.peak_share = peak > 0.0 ? run.gflops / peak : 0.0;
  return run;
}

/// The median time of a step that all threads of a team share. It is called several times in one
/// parallel region, as the network calls its steps one after the other in one.
double median_ms(int threads, const std::function<void()>& step) {
  constexpr int kCalls = 4;
  std::vector<double> times_ms;
  const auto start = Clock::now();
  while (times_ms.size() < 5 || milliseconds_since(start) < 1e3 * kStepTime_s) {
    const auto region_start = Clock::now();
#pragma omp parallel num_threads(threads)
    for (int call = 0; call < kCalls; ++call) {
      step();
    }
    times_ms.push_back(milliseconds_since(region_start) / kCalls);
    if (times_ms.size() >= 3 && milliseconds_since(start) > 5e3) {
      break;
    }
  }
  return distribution_of(std::move(times_ms)).median;
}

/// Values between -1 and 1 that repeat after a prime number.
std::vector<float> some_values(std::int64_t count) {
  std::vector<float> values(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(i * 37 % 101) / 50.0F - 1.0F;
  }
  return values;
}

void fill(Tensor& tensor) {
  for (int channel = 0; channel < tensor.channels(); ++channel) {
    for (int row = 0; row < tensor.rows(); ++row) {
      const std::vector<float> values = some_values(tensor.columns());
      std::copy(values.begin(), values.end(), tensor.row(channel, row));
    }
  }
  tensor.fill_borders();
}

template <typename Convolution>
double convolution_ms(const NetworkConvolution& layer, nn::InstructionSet instruction_set,
                      int threads) {
  Tensor input = layer.input();
  Tensor output = layer.output();
  fill(input);
  Convolution convolution(layer.shape, input, output, instruction_set, threads);
  convolution.set_parameters(some_values(layer.shape.weights()),
                             some_values(layer.shape.output_channels));
  return median_ms(threads, [&] { convolution.forward(input, {0.0F}, output); });
}

double convolution_ms(const NetworkConvolution& layer, nn::InstructionSet instruction_set,
                      int threads) {
  return layer.transposed ? convolution_ms<nn::ConvTranspose2d>(layer, instruction_set, threads)
                          : convolution_ms<nn::Conv2d>(layer, instruction_set, threads);
}

double data_consistency_ms(const nn::NetworkDescription& description, nn::TileSize tile,
                           int threads) {
  Tensor l(tile.pixels(), description.sensor.rows() / tile.rows,
           description.sensor.columns / tile.columns, nn::ColumnPadding::kCircular);
  fill(l);
  Tensor h = l;
  const nn::DataConsistency step{tile, description.measured_rows, 0.1F};
  return median_ms(threads, [&] { step.forward(l, l, l, h); });
}

double selection_ms(const nn::NetworkDescription& description, nn::InstructionSet instruction_set,
                    int threads) {
  const nn::TileSize tile = description.u_shaped.tile;
  const int rows = description.sensor.rows() / tile.rows;
  const int columns = description.sensor.columns / tile.columns;
  Tensor h(tile.pixels(), rows, columns, nn::ColumnPadding::kCircular);
  fill(h);
  const nn::Candidates candidates{h, h};
  Tensor scores(nn::kSelectionGroups * tile.pixels() + description.u_shaped.memory, rows, columns,
                nn::ColumnPadding::kCircular);
  fill(scores);
  Tensor z = h;
  return median_ms(threads, [&] { nn::select(candidates, h, tile, instruction_set, scores, z); });
}

/// All calls of the filter for one scan, on what it really gets to see.
double filter_ms(const nn::Weights& weights, const std::vector<RangeImage>& measured,
                 nn::InstructionSet instruction_set, int threads) {
  nn::SuperResolverOptions options;
  options.threads = threads;
  options.instruction_set = instruction_set;
  options.filter_result = false;
  nn::SuperResolver resolver(weights, options);
  const nn::NetworkDescription& description = weights.description;
  nn::OutlierRemoval filter(description.sensor, description.measured_rows, description.filter,
                            description.sensor.columns);
  std::vector<double> times_ms;
  for (const RangeImage& image : measured) {
    nn::Trace trace;
    std::vector<RangeImage> filtered = {resolver.run(image, &trace).image};
    for (int layer = 0;
         description.kind == nn::NetworkKind::kDuOr && layer + 1 < description.layers; ++layer) {
      filtered.push_back(description.filtered == nn::FilteredIterate::kH ? trace.layers[layer].h
                                                                         : trace.layers[layer].z);
    }
    std::vector<std::uint8_t> rejected(filtered.front().range_m.size());
    const auto start = Clock::now();
    for (const RangeImage& iterate : filtered) {
      filter.find(iterate.range_m.data(), rejected.data(), threads);
    }
    times_ms.push_back(milliseconds_since(start));
  }
  return distribution_of(std::move(times_ms)).median;
}

NetworkSteps time_steps(const nn::Weights& weights, const std::vector<RangeImage>& measured,
                        nn::InstructionSet instruction_set, int threads) {
  const nn::NetworkDescription& description = weights.description;
  const bool du_or = description.kind == nn::NetworkKind::kDuOr;
  const bool du_mix = description.kind == nn::NetworkKind::kDuMix;
  const double layers = du_mix ? 1.0 : description.layers;
  NetworkSteps result;
  result.threads = threads;
  if (!du_mix) {
    result.steps.push_back(
        {"data consistency", 0.0,
         layers * data_consistency_ms(description, tile_of(description), threads)});
  }
  for (const NetworkConvolution& layer : convolutions_of(description)) {
    result.steps.push_back({layer.name, 1e-9 * layers * static_cast<double>(layer.multiply_adds()),
                            layers * convolution_ms(layer, instruction_set, threads)});
  }
  if (du_or) {
    result.steps.push_back(
        {"selection", 0.0, layers * selection_ms(description, instruction_set, threads)});
  }
  if (du_mix) return result;
  // Few scans of a network that is slow: its filter runs once.
  const std::size_t scans = du_or ? measured.size() : 1;
  result.steps.push_back(
      {"outlier filter", 0.0,
       filter_ms(weights, {measured.begin(), measured.begin() + scans}, instruction_set, threads)});
  return result;
}

ReferenceRatio time_reference(const NetworkConvolution& layer, nn::InstructionSet instruction_set) {
  Tensor input = layer.input();
  Tensor output = layer.output();
  fill(input);
  const std::vector<float> weight = some_values(layer.shape.weights());
  const std::vector<float> bias = some_values(layer.shape.output_channels);
  ReferenceRatio ratio;
  ratio.layer = layer.name;
  ratio.reference_ms =
      median_ms(1, [&] { nn::conv2d_reference(layer.shape, weight, bias, input, output); });
  ratio.fast_ms = convolution_ms(layer, instruction_set, 1);
  return ratio;
}

}  // namespace

std::vector<MultiplyAddPeak> measure_peaks(int most_threads) {
  std::vector<MultiplyAddPeak> peaks;
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads; ++threads) {
      peaks.push_back({set, threads, nn::multiply_add_peak_gflops(set, threads)});
    }
  }
  return peaks;
}

bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images) {
  const SensorModel& sensor = weights.description.sensor;
  return !images.empty() && images.front().rows == sensor.rows() &&
         images.front().columns == sensor.columns;
}

NetworkTiming time_network(const std::string& path, const nn::Weights& weights,
                           const std::vector<RangeImage>& images,
                           const std::vector<MultiplyAddPeak>& peaks, int most_threads,
                           const InterruptGuard& interrupt) {
  const std::vector<RangeImage> measured = measured_rows_of(weights, images);
  const nn::SuperResolver resolver(weights, {});
  NetworkTiming timing;
  timing.path = path;
  timing.name = nn::name(weights.description.kind);
  timing.layers = weights.description.layers;
  timing.parameters = resolver.parameters();
  timing.gmac = 1e-9 * static_cast<double>(resolver.multiply_adds());
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
      timing.runs.push_back(time_run(weights, measured, set, threads, peaks, interrupt));
    }
  }
  timing.steps_instruction_set = nn::chosen_instruction_set();
  for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
    timing.steps.push_back(time_steps(weights, measured, timing.steps_instruction_set, threads));
  }
  timing.reference =
      time_reference(convolutions_of(weights.description).front(), timing.steps_instruction_set);
  return timing;
}

}  // namespace hqslam::tools
