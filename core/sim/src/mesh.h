#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "material.h"

namespace hqslam::sim {

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
/// An upright, leaning or lying column that may taper, without end caps at zero radius.
void add_column(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                double radius_from_m, double radius_to_m, int sides, Surface surface);
/// Adds rows x columns vertices' worth of quads; `points` is row-major.
void add_grid(TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points, int rows, int columns,
              Surface surface);

/// What shapes of one surface are added to, in a frame of their own.
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

/// Upright frame at `origin` whose x axis looks along `heading_rad`.
Eigen::Isometry3d upright_frame(const Eigen::Vector3d& origin, double heading_rad);

}  // namespace hqslam::sim
