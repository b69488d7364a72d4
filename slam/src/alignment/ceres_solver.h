#pragma once

#include <ceres/ceres.h>

namespace hqslam::slam {

/// Levenberg-Marquardt by Ceres in one thread, so that the same problem gives the same bytes, at
/// most max_steps steps. False if it found no usable solution.
inline bool solve(ceres::Problem& problem, ceres::LinearSolverType linear_solver, int max_steps) {
  ceres::Solver::Options options;
  options.linear_solver_type = linear_solver;
  options.max_num_iterations = max_steps;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable();
}

}  // namespace hqslam::slam
