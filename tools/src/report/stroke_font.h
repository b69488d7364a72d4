#pragma once

#include <Eigen/Core>
#include <vector>

namespace hqslam::tools {

/// Letters made of straight strokes, enough for the labels of a picture. Units: capitals are
/// kGlyphHeight high and at most 4 wide; y points upwards from the base line.
inline constexpr double kGlyphHeight = 6.0;

struct Glyph {
  std::vector<std::vector<Eigen::Vector2d>> strokes;  ///< from x = 0
  double advance = 0.0;                               ///< to where the next letter begins
};

/// Of a character that it does not have, a box.
Glyph glyph(char character);

}  // namespace hqslam::tools
