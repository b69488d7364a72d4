#pragma once

#include "hqslam/core/connected_components.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "made_images.h"

// Scans of all kinds of structure, and which of their pixels are outliers.
namespace hqslam::nn {

using Mask = std::vector<std::uint8_t>;

inline constexpr RowSelection kNothingMeasured{1000, 1};

using test::degrees_apart;

inline double uniform(std::mt19937& generator) {
  return static_cast<double>(generator()) / 4294967296.0;
}

inline Mask found(OutlierRemoval& removal, const RangeImage& image, int threads = 1) {
  Mask rejected(image.range_m.size(), 7);
  removal.find(image.range_m.data(), rejected.data(), threads);
  return rejected;
}

inline bool is_measured(int row, RowSelection rows) {
  return row >= rows.offset && (row - rows.offset) % rows.stride == 0;
}

/// From the breadth-first search of core, which takes whole scans only.
inline Mask from_component_labeler(const RangeImage& image, const SensorModel& sensor,
                                   RowSelection rows, const OutlierRemovalOptions& options) {
  ComponentLabeler labeler(sensor, options.min_angle_rad);
  const ConnectedComponents& result = labeler.label(image);
  Mask rejected(image.range_m.size(), 0);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const std::int32_t label = result.label[image.index(row, column)];
      rejected[image.index(row, column)] = label >= 0 && !is_measured(row, rows) &&
                                           result.components[label].pixels < options.min_pixels;
    }
  }
  return rejected;
}

enum class Kind { kEmpty, kFull, kNoise, kSparse, kSurfaces, kPatches, kMesh, kCount };

/// A random image: `share` of the pixels has a return, or of the structure's links holds.
inline RangeImage random_image(Kind kind, int rows, int columns, std::mt19937& generator) {
  RangeImage image(rows, columns);
  const double share = 0.2 + 0.75 * uniform(generator);
  const double phase = 6.3 * uniform(generator);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double dice = uniform(generator);
      double range_m = 0.0;
      if (kind == Kind::kFull) range_m = 10.0;
      if (kind == Kind::kNoise) range_m = 5.0 + 5.0 * dice;
      if (kind == Kind::kSparse) range_m = dice < 0.1 ? 8.0 : 0.0;
      if (kind == Kind::kSurfaces) {  // waves with steps and with ghosts between them
        const double angle = 2.0 * std::numbers::pi * column / columns;
        range_m = 12.0 + 4.0 * std::sin(3.0 * angle + phase) + (std::cos(9.0 * angle) > 0 ? 6 : 0);
        range_m *= dice > 0.9 ? 0.5 + 5.0 * (dice - 0.9) : 1.0 + 0.002 * dice;
      }
      if (kind == Kind::kPatches) {  // rectangles of all sizes at a few depths
        const int patch = (row / 3 * 7 + column / 5 * 3 + static_cast<int>(phase)) % 6;
        range_m = dice < 0.03 ? 0.0 : 4.0 + 3.0 * patch;
      }
      if (kind == Kind::kMesh) range_m = dice < share ? 10.0 : 0.0;  // percolating
      image.at(row, column) = static_cast<float>(range_m);
    }
  }
  return image;
}

/// Calls visit(image) with an image of every kind.
void for_each_kind(int rows, int columns, std::mt19937& generator, const auto& visit) {
  for (int kind = 0; kind < static_cast<int>(Kind::kCount); ++kind) {
    visit(random_image(static_cast<Kind>(kind), rows, columns, generator));
  }
}

/// A row of connected pixels from `first` to `last`, 10 m away.
inline void draw_run(RangeImage& image, int row, int first, int last) {
  for (int column = first; column <= last; ++column) image.at(row, column) = 10.0F;
}

}  // namespace hqslam::nn
