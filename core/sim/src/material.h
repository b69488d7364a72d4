#pragma once

#include <array>
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

/// The darkest and the brightest of each material, in its order. Rough figures of near-infrared
/// reflectance: vegetation is bright, asphalt and rubber are dark, black car paint nearly swallows
/// the beam.
constexpr std::array<std::array<double, 2>, 15> kReflectivity = {{
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

/// Diffuse reflectivity around 900 nm; a retroreflector's is above 1.
constexpr double reflectivity(Surface surface) {
  const auto& [darkest, brightest] = kReflectivity[static_cast<std::size_t>(surface.material)];
  return darkest + (brightest - darkest) * surface.shade / 255.0;
}

}  // namespace hqslam::sim
