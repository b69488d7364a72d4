#include "material.h"

#include <array>

namespace hqslam::sim {

namespace {

struct Range {
  double darkest;
  double brightest;
};

/// In the order of Material. Rough figures of near-infrared reflectance: vegetation is bright,
/// asphalt and rubber are dark, black car paint nearly swallows the beam.
constexpr std::array<Range, 15> kReflectivity = {{
    {0.12, 0.26},  // asphalt
    {0.25, 0.45},  // concrete
    {0.35, 0.60},  // grass
    {0.18, 0.70},  // plaster
    {0.10, 0.20},  // glass
    {0.20, 0.50},  // wood
    {0.40, 0.70},  // foliage
    {0.20, 0.40},  // bark
    {0.25, 0.60},  // metal
    {3.00, 6.00},  // retroreflector
    {0.04, 0.60},  // car paint
    {0.06, 0.12},  // car glass
    {0.05, 0.10},  // rubber
    {0.10, 0.70},  // cloth
    {0.10, 0.40},  // roof
}};

}  // namespace

double reflectivity(Surface surface) {
  const Range& range = kReflectivity[static_cast<std::size_t>(surface.material)];
  return range.darkest + (range.brightest - range.darkest) * surface.shade / 255.0;
}

}  // namespace hqslam::sim
