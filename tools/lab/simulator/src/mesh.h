#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace hqslam::sim {

/// Materials that a laser distinguishes.
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

/// Triangles with a surface each, metres.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Surface> surfaces;  ///< one per triangle
};

void add_triangle(TriangleMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c, Surface surface);
/// The corners in order around the quad.
void add_quad(TriangleMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
              const Eigen::Vector3d& c, const Eigen::Vector3d& d, Surface surface);
/// A box between two corners of the frame `placed`.
void add_box(TriangleMesh& mesh, const Eigen::Isometry3d& placed, const Eigen::Vector3d& low,
             const Eigen::Vector3d& high, Surface surface);
/// A column in any direction that may taper; no cap closes an end of radius 0.
void add_column(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                double radius_from_m, double radius_to_m, int sides, Surface surface);
/// Adds rows x columns vertices' worth of quads; `points` is row-major.
void add_grid(TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points, int rows, int columns,
              Surface surface);

/// A mesh to which shapes of one surface are added, in a frame of their own.
struct Part {
  TriangleMesh& mesh;
  Eigen::Isometry3d frame;
  Surface surface;

  void box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const {
    add_box(mesh, frame, low, high, surface);
  }
  void column(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius_from_m,
              double radius_to_m, int sides) const {
    add_column(mesh, frame * from, frame * to, radius_from_m, radius_to_m, sides, surface);
  }
};

/// Into how many equal steps of at most `step_m` a length is divided; at least one.
int steps(double length_m, double step_m);

/// From a point to the nearest point of a triangle, metres.
double distance_to_triangle_m(const Eigen::Vector3d& point_m, const Eigen::Vector3d& a_m,
                              const Eigen::Vector3d& b_m, const Eigen::Vector3d& c_m);

/// Upright frame at `origin` whose x axis points along `heading_rad`.
Eigen::Isometry3d upright_frame(const Eigen::Vector3d& origin, double heading_rad);

}  // namespace hqslam::sim
