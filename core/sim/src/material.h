#pragma once

#include <cstdint>

namespace hqslam::sim {

/// What a surface is made of, as far as a laser cares.
enum class Material : std::uint8_t {
  kAsphalt,
  kConcrete,
  kGrass,
  kPlaster,
  kGlass,
  kWood,
  kFoliage,
  kBark,
  kMetal,
  kRetroreflector,
  kCarPaint,
  kCarGlass,
  kRubber,
  kCloth,
  kRoof,
};

/// A material and its shade: 0 the darkest of its kind, 255 the brightest.
struct Surface {
  Material material = Material::kAsphalt;
  std::uint8_t shade = 128;
};

/// Diffuse reflectivity around 900 nm; a retroreflector's is above 1.
double reflectivity(Surface surface);

}  // namespace hqslam::sim
