#include "hqslam/pipeline/own_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam::pipeline {
namespace {

constexpr float kNear_m = 3.0F;
/// Three standard deviations of a range, and the vibration of a vehicle's parts.
constexpr float kSame_m = 0.1F;
constexpr int kConstantScans = 10;
constexpr int kMovingScans = 20;
/// Least share of all pixels beyond kNear_m; with fewer it cannot be determined whether the sensor
/// moves.
constexpr double kFewestFarShare = 0.05;
constexpr std::int32_t kFewestPixels = 10;
constexpr double kMostContinuedShare = 0.2;
/// ComponentLabeler's min_angle_rad. Beams meet floors at similarly small angles.
constexpr double kMinAngle_rad = 0.035;

/// The pixels with a return around a component.
struct Border {
  int pixels = 0;
  int continued = 0;  ///< on the same surface
};

}  // namespace

OwnParts::OwnParts(const SensorModel& sensor)
    : sensor_(sensor),
      labeler_(sensor, kMinAngle_rad),
      pixels_(static_cast<std::size_t>(sensor.rows()) * sensor.columns) {}

OrganizedCloud OwnParts::without(OrganizedCloud scan) {
  if (scan.rows != sensor_.rows() || scan.columns != sensor_.columns) {
    throw Error("own parts: scan is {}x{}, expected {}x{}", scan.rows, scan.columns, sensor_.rows(),
                sensor_.columns);
  }
  observe(scan.range_m);
  if (is_moving()) {
    const RangeImage constant = candidates(scan.range_m);
    const ConnectedComponents& found = labeler_.label(constant);
    const std::vector<bool> are_own = end_there(constant, found, scan.range_m);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      if (found.label[i] < 0) continue;
      if (are_own[static_cast<std::size_t>(found.label[i])]) pixels_[i].is_own = true;
    }
  }
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    if (!pixels_[i].is_own || pixels_[i].different > 0) continue;
    scan.range_m[i] = 0.0F;
    scan.points_m[i].setZero();
  }
  return scan;
}

double OwnParts::share() const {
  return static_cast<double>(std::ranges::count(pixels_, true, &Pixel::is_own)) /
         static_cast<double>(pixels_.size());
}

std::string OwnParts::text() const {
  std::size_t count = 0;
  float nearest_m = kNear_m;
  float farthest_m = 0.0F;
  for (const Pixel& pixel : pixels_) {
    if (!pixel.is_own) continue;
    ++count;
    nearest_m = std::min(nearest_m, pixel.range_m);
    farthest_m = std::max(farthest_m, pixel.range_m);
  }
  if (count == 0) return "";
  return fmt::format("{} of {} pixels, {:.1f} to {:.1f} m away", count, pixels_.size(), nearest_m,
                     farthest_m);
}

/// In how many successive scans a pixel may see something else: the edges of thin parts flicker.
int OwnParts::most_different(const Pixel& pixel) {
  if (pixel.is_own) return kConstantScans;
  return pixel.constant == kConstantScans ? 2 : 0;
}

/// Pixels without a return stay as they are.
void OwnParts::observe(const std::vector<float>& range_m) {
  ++scans_;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    if (!(range_m[i] > 0.0F)) continue;
    Pixel& pixel = pixels_[i];
    if (std::abs(range_m[i] - pixel.range_m) <= kSame_m) {
      pixel.different = 0;
    } else if (pixel.different < most_different(pixel)) {
      ++pixel.different;
      continue;
    } else {
      pixel = {.range_m = range_m[i], .has_changed = pixel.range_m > 0.0F};
    }
    if (pixel.constant == kConstantScans) continue;
    ++pixel.constant;
    pixel.range_m += (range_m[i] - pixel.range_m) / static_cast<float>(pixel.constant);
  }
}

bool OwnParts::is_moving() const {
  int far = 0;
  int constant = 0;
  for (const Pixel& pixel : pixels_) {
    if (pixel.range_m < kNear_m) continue;
    ++far;
    constant += pixel.constant == kConstantScans ? 1 : 0;
  }
  return scans_ > kConstantScans && 2 * constant < far &&
         far > kFewestFarShare * static_cast<double>(pixels_.size());
}

/// Their ranges; 0 elsewhere.
RangeImage OwnParts::candidates(const std::vector<float>& range_m) {
  RangeImage result(sensor_.rows(), sensor_.columns);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    Pixel& pixel = pixels_[i];
    if (pixel.constant < kConstantScans || !(range_m[i] > 0.0F) || pixel.different > 0) continue;
    if (pixel.while_moving < kMovingScans) ++pixel.while_moving;
    const bool is_candidate = pixel.while_moving == kMovingScans && pixel.range_m < kNear_m;
    if (is_candidate) result.range_m[i] = pixel.range_m;
  }
  return result;
}

/// For each component of candidates whether it ends: whether it is an own part.
std::vector<bool> OwnParts::end_there(const RangeImage& candidates,
                                      const ConnectedComponents& found,
                                      const std::vector<float>& range_m) const {
  const auto tan_min_angle = static_cast<float>(std::tan(kMinAngle_rad));
  std::vector<Border> borders(found.components.size());
  const auto compare = [&](std::size_t pixel, std::size_t other, double alpha_rad) {
    if (candidates.range_m[other] > 0.0F || !(range_m[other] > 0.0F)) return;
    // What only sometimes returns an echo, as at the least range, takes longer to become a
    // candidate.
    if (range_m[other] < kNear_m && !pixels_[other].has_changed) return;
    Border& border = borders[static_cast<std::size_t>(found.label[pixel])];
    ++border.pixels;
    border.continued += ComponentLabeler::connected(
        candidates.range_m[pixel], range_m[other], static_cast<float>(std::sin(alpha_rad)),
        static_cast<float>(std::cos(alpha_rad)), tan_min_angle);
  };
  const std::vector<double>& rows_rad = sensor_.beam_elevation_rad;
  const double column_step_rad = sensor_.column_step_rad();
  const int columns = candidates.columns;
  for (int row = 0; row < candidates.rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::size_t pixel = candidates.index(row, column);
      if (!(candidates.range_m[pixel] > 0.0F)) continue;
      for (const int step : {1, columns - 1}) {
        compare(pixel, candidates.index(row, (column + step) % columns), column_step_rad);
      }
      for (const int beside : {row - 1, row + 1}) {
        if (beside < 0 || beside == candidates.rows) continue;
        compare(pixel, candidates.index(beside, column),
                std::abs(rows_rad[row] - rows_rad[beside]));
      }
    }
  }
  std::vector<bool> result;
  for (std::size_t i = 0; i < borders.size(); ++i) {
    result.push_back(found.components[i].pixels >= kFewestPixels &&
                     borders[i].continued <= kMostContinuedShare * borders[i].pixels);
  }
  return result;
}

}  // namespace hqslam::pipeline
