#pragma once

namespace ceres {
class Problem;
}

namespace hqslam::slam {

/// How the normal equations are solved: many residuals of few parameters, or a graph of poses.
enum class NormalEquations { kDense, kSparse };

/// Levenberg-Marquardt by Ceres in one thread, so that the same problem gives the same bytes, at
/// most max_steps steps. False if it found no usable solution.
bool solve(ceres::Problem& problem, NormalEquations equations, int max_steps);

}  // namespace hqslam::slam
