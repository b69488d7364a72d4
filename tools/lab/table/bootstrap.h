#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace hqslam::tools {

/// Stands for a figure that is not there.
inline constexpr double kNoEstimate = std::numeric_limits<double>::quiet_NaN();

/// A figure computed from a sample, with its interval, or kNoEstimate.
struct Estimate {
  double value = 0.0;
  double low = 0.0;  ///< of the 95 % interval
  double high = 0.0;
};

/// A figure of a sample as a function of its members, in any order and possibly repeated; NaN where
/// they have no figure.
using SampleFigure = std::function<double(const std::vector<std::size_t>& members)>;

/// The figure of members 0 to n - 1, with its 95 % bootstrap interval by percentiles (Efron &
/// Tibshirani, 1993, chapter 13): n members are drawn with replacement 10,000 times, and 2.5 % of
/// the figures are below, 2.5 % above. Draws that have no figure are left out; if most have none,
/// or n is 1 or less, the interval is (NaN, NaN). The draws are the same in every run and on every
/// machine.
Estimate bootstrap(std::size_t n, const SampleFigure& figure);

}  // namespace hqslam::tools
