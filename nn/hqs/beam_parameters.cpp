#include "beam_parameters.h"

#include <algorithm>
#include <cmath>

#include "hqslam/core/angles.h"
#include "hqslam/nn/interpolation.h"

namespace hqslam::nn {
namespace {

constexpr double kUsualGap_deg = 1.5;
constexpr double kUsualElevation_deg = 20.0;
constexpr double kLowestTrained_deg = -48.5;  // du-mix_any-beams.json
constexpr double kHighestTrained_deg = 45.0;
constexpr double kUsualColumnStep_deg = 0.35;
constexpr const char* kRowBias = "encoder.0.row_bias";
constexpr const char* kHeadWeight = "head.weight";
constexpr const char* kHeadBias = "head.bias";

/// e'.
float elevation_place(double elevation_deg) {
  const double within_deg = std::clamp(elevation_deg, kLowestTrained_deg, kHighestTrained_deg);
  return static_cast<float>(within_deg / kUsualElevation_deg);
}

double elevation_of(const SensorModel& sensor, RowSelection rows, int beam) {
  return degrees(sensor.beam_elevation_rad[rows.offset + beam * rows.stride]);
}

/// g between a measured row and the next one below it; the nearest there is at the ends.
float gap_below(const SensorModel& sensor, RowSelection rows, int beam) {
  const int last = measured_row_count(sensor.rows(), rows) - 1;
  const int above = std::clamp(beam, 0, last - 1);
  const double gap_deg = elevation_of(sensor, rows, above) - elevation_of(sensor, rows, above + 1);
  return static_cast<float>(std::log(gap_deg / kUsualGap_deg));
}

}  // namespace

RowPlace row_place(const SensorModel& sensor, RowSelection rows, int row) {
  const int last = measured_row_count(sensor.rows(), rows) - 1;
  const int own = row / rows.stride;
  const bool is_above = row % rows.stride < rows.offset;
  const int other = is_above ? own - 1 : own + 1;
  const double elevation_deg = degrees(sensor.beam_elevation_rad[row]);
  const double own_deg = elevation_of(sensor, rows, own);
  const float g = gap_below(sensor, rows, is_above ? other : own);
  const double gap_deg = kUsualGap_deg * std::exp(g);
  const auto distance = static_cast<float>(std::fabs(elevation_deg - own_deg) / gap_deg);
  const bool is_outside = other < 0 || other > last;
  const float v = is_outside ? 0.0F : 2.0F * distance - 1.0F;
  const float e = elevation_place(elevation_deg);
  const float o = is_outside ? 1.0F : 0.0F;
  const std::array<float, kRowPlaces / 2> phi = {
      1.0F, v, v * v, v * v * v, g, g * v, e, e * v, e * e, o, o * std::min(distance, 2.0F)};
  RowPlace place{};
  std::ranges::copy(phi, place.begin() + (is_above ? 0 : kRowPlaces / 2));
  return place;
}

BeamPlace beam_place(const SensorModel& sensor, RowSelection rows, int beam) {
  const int last = measured_row_count(sensor.rows(), rows) - 1;
  const float e = elevation_place(elevation_of(sensor, rows, beam));
  const double column_step_deg = degrees(sensor.column_step_rad());
  return {gap_below(sensor, rows, beam - 1),
          gap_below(sensor, rows, beam),
          e,
          e * e,
          beam == 0 ? 1.0F : 0.0F,
          beam == last ? 1.0F : 0.0F,
          static_cast<float>(std::log(column_step_deg / kUsualColumnStep_deg))};
}

BeamParameters::BeamParameters(const SensorModel& sensor, RowSelection measured_rows, TileSize tile,
                               std::vector<ParameterShape> of_graph)
    : of_graph_(std::move(of_graph)), shapes_(of_graph_), tile_columns_(tile.columns), outputs_(0) {
  const int beams = measured_row_count(sensor.rows(), measured_rows);
  for (int beam = 0; beam < beams; ++beam) {
    beams_.push_back(beam_place(sensor, measured_rows, beam));
  }
  for (int row = 0; row < sensor.rows(); ++row) {
    if (measured_rows.contains(row)) continue;
    rows_.push_back(row_place(sensor, measured_rows, row));
  }
  const int computed = (tile.rows - 1) * tile.columns;
  for (ParameterShape& shape : shapes_) {
    if (shape.name == kRowBias) {
      shape = {"encoder.0.beam_bias", {kBeamPlaces, shape.shape[0]}};
    } else if (shape.name == kHeadWeight || shape.name == kHeadBias) {
      outputs_ = static_cast<int>(shape.shape[1]) / computed;
      shape.shape[0] = kRowPlaces;
      shape.shape[1] = static_cast<std::int64_t>(outputs_) * tile.columns;
    }
  }
}

/// inputs: values for each output.
template <typename Visit>
void BeamParameters::for_each_head_term(std::size_t graph, std::size_t shared, std::size_t inputs,
                                        const Visit& visit) const {
  const std::size_t tiles = beams_.size();
  const std::size_t rows = rows_.size() / tiles;
  const std::size_t of_group = rows * tile_columns_;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const std::size_t tile = row / rows;
    for (int output = 0; output < outputs_; ++output) {
      const std::size_t first = (tile * outputs_ + output) * of_group + row % rows * tile_columns_;
      for (int k = 0; k < kRowPlaces; ++k) {
        if (rows_[row][k] == 0.0F) continue;
        const std::size_t from = (static_cast<std::size_t>(k) * outputs_ + output) * tile_columns_;
        visit(graph + first * inputs, shared + from * inputs, tile_columns_ * inputs,
              rows_[row][k]);
      }
    }
  }
}

/// Calls visit(graph, shared, count, share): of `count` parameters of the graph's from place
/// `graph` on, `share` of the shared ones from `shared` on is a part.
template <typename Visit>
void BeamParameters::for_each_term(const Visit& visit) const {
  std::size_t graph = 0;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const std::vector<std::int64_t>& shape = of_graph_[i].shape;
    if (of_graph_[i].name == kRowBias) {
      const std::size_t channels = shape[0];
      for (std::size_t channel = 0; channel < channels; ++channel) {
        for (std::size_t beam = 0; beam < beams_.size(); ++beam) {
          for (int k = 0; k < kBeamPlaces; ++k) {
            visit(graph + channel * beams_.size() + beam, shared + k * channels + channel,
                  std::size_t{1}, beams_[beam][k]);
          }
        }
      }
    } else if (of_graph_[i].name == kHeadWeight || of_graph_[i].name == kHeadBias) {
      for_each_head_term(graph, shared, shape.size() > 2 ? shape[2] : 1, visit);
    } else {
      visit(graph, shared, static_cast<std::size_t>(shapes_[i].elements()), 1.0F);
    }
    graph += of_graph_[i].elements();
    shared += shapes_[i].elements();
  }
}

std::vector<float> BeamParameters::of_graph(std::span<const float> shared) const {
  std::vector<float> graph(elements(of_graph_), 0.0F);
  for_each_term([&](std::size_t to, std::size_t from, std::size_t count, float share) {
    for (std::size_t i = 0; i < count; ++i) graph[to + i] += share * shared[from + i];
  });
  return graph;
}

void BeamParameters::add_gradient(std::span<const float> d_graph, std::span<float> d_shared) const {
  for_each_term([&](std::size_t from, std::size_t to, std::size_t count, float share) {
    for (std::size_t i = 0; i < count; ++i) d_shared[to + i] += share * d_graph[from + i];
  });
}

std::vector<float> BeamParameters::start(std::span<const float> graph) const {
  std::vector<float> shared(elements(shapes_), 0.0F);
  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const auto count = static_cast<std::size_t>(shapes_[i].elements());
    if (of_graph_[i].shape == shapes_[i].shape) {
      std::copy_n(graph.begin() + from, count, shared.begin() + to);
    } else if (of_graph_[i].name != kRowBias) {  // the constant of either half
      const std::size_t of_k = count / kRowPlaces;
      for (const int k : {0, kRowPlaces / 2}) {
        std::copy_n(graph.begin() + from, of_k, shared.begin() + to + k * of_k);
      }
    }
    from += of_graph_[i].elements();
    to += count;
  }
  return shared;
}

}  // namespace hqslam::nn
