#include <array>
#include <cmath>

#include "scan.h"

// Q of eq. 3 and 10c: connected components of a range image by breadth-first search, with the
// criterion of eq. 9 (Bogoslavskyi & Stachniss, IROS 2016).
namespace hqslam::nn::reference {
namespace {

struct Pixel {
  int row = 0;
  int column = 0;
};

/// Whether two neighbours whose beams are alpha apart are on one surface: the angle between the
/// longer beam and the line through both points is larger than min_angle.
bool connected(double a_m, double b_m, double alpha_rad, double min_angle_rad) {
  const double farther_m = std::max(a_m, b_m);
  const double nearer_m = std::min(a_m, b_m);
  const double angle_rad =
      std::atan2(nearer_m * std::sin(alpha_rad), farther_m - nearer_m * std::cos(alpha_rad));
  return angle_rad > min_angle_rad;
}

/// A small component's pixel stays if its range is within a share of one that was measured in the
/// next measured row above or below it, in its column or one beside it: a thin pole, an edge.
bool supported(const Image& h_m, RowSelection rows, double share, Pixel pixel) {
  const int above =
      pixel.row < rows.offset ? -1 : pixel.row - (pixel.row - rows.offset) % rows.stride;
  const int below = above < 0 ? rows.offset : above + rows.stride;
  for (const int row : {above, below}) {
    for (const int column : {pixel.column - 1, pixel.column, pixel.column + 1}) {
      const double measured_m = value_at(h_m, Beyond::kOtherEnd, 0, row, column);
      if (std::fabs(h_m(0, pixel.row, pixel.column) - measured_m) < share * measured_m) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

std::vector<std::uint8_t> outliers(const SensorModel& sensor, RowSelection measured_rows,
                                   const OutlierRemovalOptions& options, const Image& h_m) {
  const auto rows = static_cast<int>(h_m.dimension(1));
  const auto columns = static_cast<int>(h_m.dimension(2));
  std::vector<std::uint8_t> rejected(h_m.size());
  std::vector<std::uint8_t> seen(h_m.size());
  const auto index = [&](Pixel p) { return static_cast<std::size_t>(p.row) * columns + p.column; };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (seen[index({row, column})] != 0 || h_m(0, row, column) <= 0.0) continue;
      std::vector<Pixel> component{{row, column}};  // and the queue of the search
      seen[index({row, column})] = 1;
      for (std::size_t next = 0; next < component.size(); ++next) {
        const Pixel from = component[next];
        const std::array<Pixel, 4> neighbours{
            Pixel{from.row - 1, from.column}, Pixel{from.row + 1, from.column},
            Pixel{from.row, (from.column + columns - 1) % columns},
            Pixel{from.row, (from.column + 1) % columns}};
        for (const Pixel to : neighbours) {
          if (to.row < 0 || to.row >= rows || seen[index(to)] != 0) continue;
          const double to_m = h_m(0, to.row, to.column);
          const double alpha_rad = to.row == from.row
                                       ? sensor.column_step_rad()
                                       : std::fabs(sensor.beam_elevation_rad[from.row] -
                                                   sensor.beam_elevation_rad[to.row]);
          if (to_m <= 0.0 ||
              !connected(h_m(0, from.row, from.column), to_m, alpha_rad, options.min_angle_rad)) {
            continue;
          }
          seen[index(to)] = 1;
          component.push_back(to);
        }
      }
      if (std::ssize(component) >= options.min_pixels) continue;
      for (const Pixel pixel : component) {
        rejected[index(pixel)] = !measured_rows.contains(pixel.row) &&
                                 !supported(h_m, measured_rows, options.support_share, pixel);
      }
    }
  }
  return rejected;
}

}  // namespace hqslam::nn::reference
