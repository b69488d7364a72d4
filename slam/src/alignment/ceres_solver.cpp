#include "alignment/ceres_solver.h"

#include <ceres/ceres.h>

namespace hqslam::slam {

bool solve(ceres::Problem& problem, NormalEquations equations, int max_steps) {
  ceres::Solver::Options options;
  options.linear_solver_type = equations == NormalEquations::kDense ? ceres::DENSE_NORMAL_CHOLESKY
                                                                    : ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_steps;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable();
}

}  // namespace hqslam::slam
