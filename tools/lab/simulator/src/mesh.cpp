#include "mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hqslam::sim {

namespace {

std::uint32_t add_vertex(TriangleMesh& mesh, const Eigen::Vector3d& vertex) {
  mesh.vertices_m.push_back(vertex.cast<float>());
  return static_cast<std::uint32_t>(mesh.vertices_m.size() - 1);
}

void connect(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
             Surface surface) {
  mesh.triangles.push_back({a, b, c});
  mesh.surfaces.push_back(surface);
}

double squared_distance_to_edge_m2(const Eigen::Vector3d& point_m, const Eigen::Vector3d& from_m,
                                   const Eigen::Vector3d& to_m) {
  const Eigen::Vector3d along_m = to_m - from_m;
  const double length_m2 = along_m.squaredNorm();
  const double fraction =
      length_m2 > 0.0 ? std::clamp((point_m - from_m).dot(along_m) / length_m2, 0.0, 1.0) : 0.0;
  return (point_m - from_m - fraction * along_m).squaredNorm();
}

}  // namespace

void add_triangle(TriangleMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c, Surface surface) {
  const std::uint32_t first = add_vertex(mesh, a);
  add_vertex(mesh, b);
  add_vertex(mesh, c);
  connect(mesh, first, first + 1, first + 2, surface);
}

void add_quad(TriangleMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
              const Eigen::Vector3d& c, const Eigen::Vector3d& d, Surface surface) {
  const std::uint32_t first = add_vertex(mesh, a);
  add_vertex(mesh, b);
  add_vertex(mesh, c);
  add_vertex(mesh, d);
  connect(mesh, first, first + 1, first + 2, surface);
  connect(mesh, first, first + 2, first + 3, surface);
}

void add_box(TriangleMesh& mesh, const Eigen::Isometry3d& placed, const Eigen::Vector3d& low,
             const Eigen::Vector3d& high, Surface surface) {
  std::array<Eigen::Vector3d, 8> corner;
  for (std::size_t bits = 0; bits < 8; ++bits) {
    corner[bits] = placed * Eigen::Vector3d((bits & 1U) != 0 ? high.x() : low.x(),
                                            (bits & 2U) != 0 ? high.y() : low.y(),
                                            (bits & 4U) != 0 ? high.z() : low.z());
  }
  constexpr std::array<std::array<std::size_t, 4>, 6> kFaces = {
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  for (const auto& face : kFaces) {
    add_quad(mesh, corner[face[0]], corner[face[1]], corner[face[2]], corner[face[3]], surface);
  }
}

void add_column(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                double radius_from_m, double radius_to_m, int sides, Surface surface) {
  const Eigen::Vector3d axis = (to - from).normalized();
  const Eigen::Vector3d side_a = axis.unitOrthogonal();
  const Eigen::Vector3d side_b = axis.cross(side_a);
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  for (int side = 0; side < sides; ++side) {
    const double angle_rad = 2.0 * std::numbers::pi * side / sides;
    const Eigen::Vector3d out = std::cos(angle_rad) * side_a + std::sin(angle_rad) * side_b;
    add_vertex(mesh, from + radius_from_m * out);
    add_vertex(mesh, to + radius_to_m * out);
  }
  const auto count = static_cast<std::uint32_t>(sides);
  for (std::uint32_t side = 0; side < count; ++side) {
    const std::uint32_t a = first + 2 * side;
    const std::uint32_t b = first + 2 * ((side + 1) % count);
    connect(mesh, a, b, b + 1, surface);
    connect(mesh, a, b + 1, a + 1, surface);
  }
  if (radius_to_m > 0.0) {
    for (std::uint32_t side = 1; side + 1 < count; ++side) {
      connect(mesh, first + 1, first + 2 * side + 1, first + 2 * side + 3, surface);
    }
  }
}

void add_grid(TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points, int rows, int columns,
              Surface surface) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  for (const Eigen::Vector3d& point : points) add_vertex(mesh, point);
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const std::uint32_t a = first + static_cast<std::uint32_t>(row * columns + column);
      const std::uint32_t below = a + static_cast<std::uint32_t>(columns);
      connect(mesh, a, a + 1, below + 1, surface);
      connect(mesh, a, below + 1, below, surface);
    }
  }
}

int steps(double length_m, double step_m) {
  return std::max(1, static_cast<int>(std::ceil(length_m / step_m)));
}

Eigen::Isometry3d upright_frame(const Eigen::Vector3d& origin, double heading_rad) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  frame.translation() = origin;
  return frame;
}

// The foot of the point on the plane is the nearest point if it is inside all three edges;
// otherwise the nearest point is on an edge.
double distance_to_triangle_m(const Eigen::Vector3d& point_m, const Eigen::Vector3d& a_m,
                              const Eigen::Vector3d& b_m, const Eigen::Vector3d& c_m) {
  const Eigen::Vector3d normal = (b_m - a_m).cross(c_m - a_m);
  const auto is_inside = [&](const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
    return (to_m - from_m).cross(point_m - from_m).dot(normal) >= 0.0;
  };
  const double length = normal.norm();
  if (length > 0.0 && is_inside(a_m, b_m) && is_inside(b_m, c_m) && is_inside(c_m, a_m)) {
    return std::abs(normal.dot(point_m - a_m)) / length;
  }
  return std::sqrt(std::min({squared_distance_to_edge_m2(point_m, a_m, b_m),
                             squared_distance_to_edge_m2(point_m, b_m, c_m),
                             squared_distance_to_edge_m2(point_m, c_m, a_m)}));
}

}  // namespace hqslam::sim
