#include "map/map_matching.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace hqslam::slam {

namespace {

/// Smallest ratio of the variances along and across a line. LOAM has 3, which five points in a
/// corner reach by chance.
constexpr double kMinLineElongation = 10.0;

/// Smallest ratio of the variances across and along a patch: points of a single row are a line,
/// through which any plane goes.
constexpr double kMinPlaneWidthShare = 0.1;

/// Standard deviation of the map's points, which are means in voxels, beside what five of them
/// show.
constexpr double kPointSigma_m = 0.01;

/// Standard deviation of the slope of a fit through points of variance `along`, which are away from
/// it by the variance `across`. free: the number of points less that of the fit's parameters.
double slope_sigma(double across, double along, int free) {
  constexpr double kPoints = Neighbours::kWanted;
  return std::sqrt((across * kPoints / free + kPointSigma_m * kPointSigma_m) / (kPoints * along));
}

struct Spread {
  Eigen::Vector3d mean_m;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;  ///< of the covariance, smallest first
};

Spread spread_of(const Neighbours& neighbours) {
  Spread result;
  result.mean_m.setZero();
  for (const auto& point_m : neighbours.points_m) result.mean_m += point_m.cast<double>();
  result.mean_m /= Neighbours::kWanted;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& point_m : neighbours.points_m) {
    const Eigen::Vector3d offset_m = point_m.cast<double>() - result.mean_m;
    covariance += offset_m * offset_m.transpose();
  }
  result.solver.computeDirect(covariance / Neighbours::kWanted);
  return result;
}

std::optional<MapLine> line_of(const Spread& spread) {
  const Eigen::Vector3d& eigenvalues = spread.solver.eigenvalues();
  if (!(eigenvalues[2] > kMinLineElongation * eigenvalues[1])) return std::nullopt;
  return MapLine{spread.mean_m, spread.solver.eigenvectors().col(2),
                 slope_sigma(eigenvalues[1], eigenvalues[2], 3)};
}

std::optional<MapPlane> plane_of(const Neighbours& neighbours, const Spread& spread,
                                 double max_residual_m) {
  const Eigen::Vector3d& eigenvalues = spread.solver.eigenvalues();
  if (!(eigenvalues[1] >= kMinPlaneWidthShare * eigenvalues[2])) return std::nullopt;
  const MapPlane plane{
      spread.mean_m, spread.solver.eigenvectors().col(0),
      slope_sigma(eigenvalues[0], eigenvalues[1], 2) * spread.solver.eigenvectors().col(1)};
  for (const auto& point_m : neighbours.points_m) {
    const double residual_m = plane.normal.dot(point_m.cast<double>() - plane.point_m);
    if (!(std::abs(residual_m) <= max_residual_m)) return std::nullopt;
  }
  return plane;
}

}  // namespace

std::optional<MapLine> fit_line(const Neighbours& neighbours) {
  if (neighbours.count < Neighbours::kWanted) return std::nullopt;
  return line_of(spread_of(neighbours));
}

std::optional<MapPlane> fit_plane(const Neighbours& neighbours, double max_residual_m) {
  if (neighbours.count < Neighbours::kWanted) return std::nullopt;
  return plane_of(neighbours, spread_of(neighbours), max_residual_m);
}

std::optional<MapSurface> fit_surface(const Neighbours& neighbours, double max_residual_m) {
  if (neighbours.count < Neighbours::kWanted) return std::nullopt;
  const Spread spread = spread_of(neighbours);
  if (const auto plane = plane_of(neighbours, spread, max_residual_m)) return *plane;
  if (const auto line = line_of(spread)) return *line;
  return std::nullopt;
}

}  // namespace hqslam::slam
