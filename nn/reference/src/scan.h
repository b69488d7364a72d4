#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/reference/reference.h"
#include "layers.h"

namespace hqslam::nn::reference {

/// The learned arrays of a network by their names.
class Parameters {
 public:
  /// values: all arrays of parameter_shapes(description), one after the other. Throws Error for
  /// another number.
  Parameters(const NetworkDescription& description, std::span<const double> values);
  const Array& operator[](const std::string& name) const { return arrays_.at(name); }

 private:
  std::map<std::string, Array> arrays_;
};

/// The inputs of one run of the reference, and the trace that it writes.
struct Run {
  const NetworkDescription& description;
  nlohmann::json network;  ///< the description as JSON: sizes of the layers
  Parameters parameters;
  const RangeImage& measured_m;
  const ReferenceOptions& options;
  ReferenceTrace trace;

  int rows() const { return description.sensor.rows(); }
  int columns() const { return measured_m.columns; }
  bool is_measured(int row) const { return description.measured_rows.contains(row); }
  /// image times `unit_m` under this name.
  void add(const std::string& name, const Image& image, const std::string& unit = "",
           double unit_m = 1.0);
};

/// The measured rows between which an image row is, and its place between them (0: at `above`, 1:
/// at `below`); beyond the outermost ones both are the outermost.
struct Between {
  int above = 0;
  int below = 0;
  double part_down = 0.0;
};
/// part_down counts rows.
Between between(const Run& run, int row);

/// An image cut into tiles: pixel (y, x) becomes channel (y mod tile rows) tile columns +
/// x mod tile columns of place (y / tile rows, x / tile columns).
/// image: 1 x rows x columns. Returns tile rows tile columns x rows / tile rows x ...
Image tiled(const Image& image, int tile_rows, int tile_columns);
/// The inverse, from as many channels from `first` on.
Image untiled(const Image& tiles, int first, int tile_rows, int tile_columns);

/// Q: 1 where a pixel of H (1 x rows x columns, metres) belongs to a connected component of fewer
/// than min_pixels pixels and nothing measured supports it. Measured pixels are never rejected.
std::vector<std::uint8_t> outliers(const SensorModel& sensor, RowSelection measured_rows,
                                   const OutlierRemovalOptions& options, const Image& h_m);

/// DU-OR and Simple DU (hqs.cpp), DU-Mix (du_mix.cpp).
void run_hqs(Run& run);
void run_du_mix(Run& run);
/// The priors of the first two: Z = G(H), images in units of range_scale_m. DU-OR's hands memory
/// from layer to layer, and chooses between H and the measured ranges above and below.
Image du_or_prior(Run& run, int k, const Image& h, const Image& above, const Image& below,
                  Image& memory);
Image simple_du_prior(Run& run, int k, const Image& h);

}  // namespace hqslam::nn::reference
