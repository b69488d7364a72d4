#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/angles.h"
#include "scan.h"

// The unrolled loop, eq. 10 of "Fast and Accurate Outlier-Aware LiDAR Super-Resolution for SLAM
// Applications" (ICIP 2025), with the notation of its section 2. All images are 1 x rows x columns,
// in units of range_scale_m, 0 = no return.
namespace hqslam::nn::reference {
namespace {

struct MeasuredAround {
  Image above;   ///< of each pixel the measured range in the row above it ...
  Image below;   ///< ... and below it; in a measured row both are its own, L
  Image linear;  ///< interpolated linearly between them
};

MeasuredAround measured_around(const Run& run) {
  const Image empty = zeros(1, run.rows(), run.columns());
  MeasuredAround m{empty, empty, empty};
  const double scale_m = run.description.range_scale_m;
  for (int y = 0; y < run.rows(); ++y) {
    const Between at = between(run, y);
    for (int x = 0; x < run.columns(); ++x) {
      const double u = run.measured_m.at(at.above, x) / scale_m;
      const double d = run.measured_m.at(at.below, x) / scale_m;
      m.above(0, y, x) = u;
      m.below(0, y, x) = d;
      // A mean with "no return" would be a range that nothing has: then the nearer row decides.
      const bool both = u > 0.0 && d > 0.0;
      const double nearest = at.part_down < 0.5 ? u : d;
      m.linear(0, y, x) = both ? (1.0 - at.part_down) * u + at.part_down * d : nearest;
    }
  }
  return m;
}

/// Eq. 10a, solved pixel by pixel: H = (L + b (Z + Y)) / (1 + 2 b) where a pixel was measured,
/// (Z + Y) / 2 where not. (The paper has D^T Y where D^T L is meant.)
Image data_step(const Run& run, const Image& l, const Image& z, const Image& y, double b) {
  Image h = z;
  for (int row = 0; row < h.dimension(1); ++row) {
    for (int x = 0; x < h.dimension(2); ++x) {
      const double pull = z(0, row, x) + y(0, row, x);
      h(0, row, x) =
          run.is_measured(row) ? (l(0, row, x) + b * pull) / (1.0 + 2.0 * b) : 0.5 * pull;
    }
  }
  return h;
}

OutlierRemovalOptions filter_options(const nlohmann::json& json) {
  OutlierRemovalOptions options;
  options.min_angle_rad = radians(json["min_angle_deg"].get<double>());
  options.min_pixels = json["min_pixels"];
  options.support_share = json["support_share"];
  return options;
}

/// What Q rejects of an image; given, or found here.
std::vector<std::uint8_t> rejected(const Run& run, int k, const Image& image) {
  if (!run.options.rejected.empty()) return run.options.rejected[k];
  const double scale_m = run.description.range_scale_m;
  Image seen_m = image * scale_m;
  for (int row = 0; row < run.rows(); ++row) {
    for (int x = 0; x < run.columns(); ++x) {
      if (seen_m(0, row, x) < run.description.sensor.min_range_m) seen_m(0, row, x) = 0.0;
    }
  }
  return outliers(run.description.sensor, run.description.measured_rows,
                  filter_options(run.network["filter"]), seen_m);
}

/// Eq. 10c: Y is the filtered iterate, H as in the paper's equation or Z as in its prose. In a
/// rejected pixel it is the other one, or the paper's 0, which halves the range in the next layer's
/// mean of Z and Y.
Image filter_step(const Image& filtered, const Image& other, bool takes_zero,
                  const std::vector<std::uint8_t>& rejected) {
  Image y = filtered;
  std::size_t pixel = 0;
  for (int row = 0; row < y.dimension(1); ++row) {
    for (int x = 0; x < y.dimension(2); ++x) {
      if (rejected[pixel++] != 0) y(0, row, x) = takes_zero ? 0.0 : other(0, row, x);
    }
  }
  return y;
}

/// b of layer k.
double penalty(Run& run, int k) {
  if (run.network.contains("penalty")) return run.network["penalty"];
  if (run.network["kind"] == "simple-du") return 0.5 / run.parameters["alpha"].values[0];
  const std::span<const double> logs = run.parameters["log_penalty"].values;
  return std::exp(logs[static_cast<std::size_t>(k) % logs.size()]);
}

}  // namespace

void run_hqs(Run& run) {
  const bool du_or = run.network["kind"] == "du-or";  // otherwise Simple DU
  const double scale_m = run.description.range_scale_m;
  const int layers = run.network["layers"];
  const bool filters_z = run.network["filtered_iterate"] == "z";
  const bool takes_zero = run.network["rejected_pixel"] == "zero";
  const bool filters = run.network["filter"]["min_pixels"] > 0;
  const MeasuredAround m = measured_around(run);
  Image z = m.linear;       // Z0 = Y0: L interpolated ...
  if (!du_or) z.setZero();  // ... or nothing
  Image y = z;
  Image memory;
  run.add("start", z, "m", scale_m);
  for (int k = 0; k < layers; ++k) {
    const std::string prefix = fmt::format("layers.{}.", k);
    const Image h = data_step(run, m.below, z, y, penalty(run, k));  // 10a
    run.add(prefix + "h", h, "m", scale_m);
    z = du_or ? du_or_prior(run, k, h, m.above, m.below, memory)  // 10b
              : simple_du_prior(run, k, h);
    run.add(prefix + "z", z, "m", scale_m);
    if (!du_or) {
      y = z;  // Simple DU has no Y: Z pulls alone, and there is no filter inside
      continue;
    }
    std::vector<std::uint8_t> mask(z.size());
    if (filters) mask = rejected(run, k, filters_z ? z : h);
    y = filters_z ? filter_step(z, h, takes_zero, mask)
                  : filter_step(h, z, takes_zero, mask);  // 10c
    Image mask_image = y;
    std::ranges::copy(mask, mask_image.data());
    run.add(prefix + "rejected", mask_image);
    run.add(prefix + "y", y, "m", scale_m);
  }
}

}  // namespace hqslam::nn::reference
