#pragma once

#include <array>
#include <span>
#include <vector>

#include "hqslam/nn/network_description.h"
#include "tiles.h"

namespace hqslam::nn {

/// Where a computed row of the result lies among the beams, as numbers of order one. A row between
/// two measured rows belongs to the tile of one of them, its own; v runs from -1 at its own row to
/// 1 at the other. With the gap between the two beams in degrees, the row's elevation e:
///   phi = 1, v, v^2, v^3, g, g v, e', e' v, e'^2, o, d;  g = ln(gap / 1.5), e' = e / 20
/// An elevation beyond those of training (-48.5 to 45 degrees) counts as the nearest of them: the
/// powers of e' mean nothing there. Beyond the outermost measured rows v counts as 0, o is 1 and d
/// is the distance in gaps, at most 2; elsewhere both are 0. Rows above their own one fill the
/// first half of the values, rows below it the second; the other half is 0, because the ground is
/// below.
inline constexpr int kRowPlaces = 22;
using RowPlace = std::array<float, kRowPlaces>;
/// row: of the result, not measured. tile_rows: the number of rows for each measured one.
RowPlace row_place(const SensorModel& sensor, RowSelection measured_rows, int row);

/// A measured row among the others:
///   psi = g above, g below, e', e'^2, first, last, c;  c = ln(column step / 0.35 degrees)
/// g as above; beyond the outermost rows that of the other side. first, last: 1 in these rows.
inline constexpr int kBeamPlaces = 7;
using BeamPlace = std::array<float, kBeamPlaces>;
/// beam: counts measured rows, from the top.
BeamPlace beam_place(const SensorModel& sensor, RowSelection measured_rows, int beam);

/// One set of parameters for every table of beams: those of a graph whose first layer has a bias
/// for each row and whose head has weights for each row, as linear functions of where the rows lie:
///   row_bias[c][r] = sum_k psi_k(r) B[k][c]
///   weight[r][(o, j, x)] = sum_k phi_k(row j of tile r) W[k][(o, x)],  bias alike
/// for output o of column x of a tile. All other arrays are the graph's own. An addition to the
/// paper, whose networks are trained for one sensor.
class BeamParameters {
 public:
  /// of_graph: the graph's arrays for the sensor's images in tiles.
  BeamParameters(const SensorModel& sensor, RowSelection measured_rows, TileSize tile,
                 std::vector<ParameterShape> of_graph);

  /// In the order of the graph's, with beam_bias in the place of row_bias.
  const std::vector<ParameterShape>& shapes() const { return shapes_; }
  /// The graph's parameters.
  std::vector<float> of_graph(std::span<const float> shared) const;
  /// Adds the gradients of the shared parameters, from those of the graph's.
  void add_gradient(std::span<const float> d_graph, std::span<float> d_shared) const;
  /// Starting values, from the graph's: functions that do not depend on the row.
  std::vector<float> start(std::span<const float> graph) const;

 private:
  template <typename Visit>
  void for_each_term(const Visit& visit) const;
  template <typename Visit>
  void for_each_head_term(std::size_t graph, std::size_t shared, std::size_t inputs,
                          const Visit& visit) const;

  std::vector<ParameterShape> of_graph_;
  std::vector<ParameterShape> shapes_;
  std::vector<BeamPlace> beams_;
  std::vector<RowPlace> rows_;  ///< of the computed rows, tile by tile
  int tile_columns_;
  int outputs_;  ///< of a pixel
};

}  // namespace hqslam::nn
