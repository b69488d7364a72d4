#include "hqslam/nn/training/drawn_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "random.h"

namespace hqslam::nn {
namespace {

double between(Random& random, double low, double high) {
  return low + random.unit() * (high - low);
}

struct BeamCount {
  int measured;
  int stride;
  double share;
  double smallest_gap_deg;  ///< between measured rows: those of makers' sensors, and some more
  double largest_gap_deg;
};
constexpr std::array<BeamCount, 6> kCounts = {{{16, 4, 0.60, 1.0, 4.0},
                                               {16, 2, 0.08, 0.6, 3.0},
                                               {32, 2, 0.12, 0.6, 2.8},
                                               {32, 4, 0.10, 1.0, 2.8},
                                               {64, 2, 0.04, 0.5, 1.4},
                                               {8, 4, 0.06, 1.5, 5.0}}};

BeamCount draw_count(Random& random) {
  double rest = random.unit();
  for (const BeamCount& count : kCounts) {
    if (rest < count.share) return count;
    rest -= count.share;
  }
  return kCounts.front();
}

/// Elevations of the measured rows, degrees, from the top, around 0.
std::vector<double> drawn_table(const BeamCount& count, Random& random) {
  constexpr double kEven = 0.6;
  constexpr double kLargestChange = 0.35;
  const double gap_deg = count.smallest_gap_deg *
                         std::pow(count.largest_gap_deg / count.smallest_gap_deg, random.unit());
  const bool is_even = random.unit() < kEven;
  double change = 0.0;
  std::vector<double> table{0.0};
  for (int beam = 1; beam < count.measured; ++beam) {
    change = std::clamp(change + between(random, -kLargestChange, kLargestChange), -1.0, 1.0);
    table.push_back(table.back() - gap_deg * (is_even ? 1.0 : std::exp(0.6 * change)));
  }
  const double middle = 0.5 * table.back();
  for (double& elevation : table) elevation -= middle;
  return table;
}

/// The table of a preset that has as many rows, or a multiple of them; empty: there is none.
std::vector<double> preset_table(const BeamCount& count, Random& random) {
  std::vector<std::string> fitting;
  for (const std::string& name : sensor_preset_names()) {
    if (sensor_preset(name).rows() % count.measured == 0) fitting.push_back(name);
  }
  if (fitting.empty()) return {};
  const SensorModel sensor = sensor_preset(fitting[random.below(std::ssize(fitting))]);
  const int stride = sensor.rows() / count.measured;
  std::vector<double> table;
  for (int beam = 0; beam < count.measured; ++beam) {
    table.push_back(degrees(sensor.beam_elevation_rad[beam * stride + stride - 1]));
  }
  return table;
}

/// The measured rows and those between them, degrees: as many above the first or below the last as
/// the offset wants.
std::vector<double> with_rows_between(const std::vector<double>& table, RowSelection rows) {
  std::vector<double> all;
  const auto last = static_cast<int>(table.size()) - 1;
  for (int row = 0; row < std::ssize(table) * rows.stride; ++row) {
    const double place = static_cast<double>(row - rows.offset) / rows.stride;
    const int above = std::clamp(static_cast<int>(std::floor(place)), 0, last - 1);
    all.push_back(table[above] + (place - above) * (table[above + 1] - table[above]));
  }
  return all;
}

int nearest_row(const SensorModel& all, double elevation_deg) {
  const std::vector<double>& falling = all.beam_elevation_rad;
  const double wanted = radians(elevation_deg);
  const auto after = std::ranges::lower_bound(falling, wanted, std::greater<>());
  if (after == falling.begin()) return 0;
  if (after == falling.end()) return all.rows() - 1;
  const auto before = after - 1;
  return static_cast<int>((*before - wanted < wanted - *after ? before : after) - falling.begin());
}

/// Rows near these elevations, each below the one before it.
DrawnBeams with_rows(const SensorModel& all, const std::vector<double>& elevation_deg) {
  DrawnBeams beams{all, {}, {}};
  const auto count = static_cast<int>(elevation_deg.size());
  for (int i = 0; i < count; ++i) {
    const int first = beams.rows.empty() ? 0 : beams.rows.back() + 1;
    beams.rows.push_back(
        std::clamp(nearest_row(all, elevation_deg[i]), first, all.rows() - count + i));
  }
  beams.sensor.beam_elevation_rad.clear();
  for (const int row : beams.rows) {
    beams.sensor.beam_elevation_rad.push_back(all.beam_elevation_rad[row]);
  }
  beams.sensor.beam_azimuth_offset_rad.assign(beams.rows.size(), 0.0);
  return beams;
}

}  // namespace

DrawnBeams draw_beams(const SensorModel& all, std::uint64_t seed, bool any_offset) {
  constexpr double kPresets = 0.25;
  constexpr double kShortSighted = 0.3;
  Random random(seed);
  const BeamCount count = draw_count(random);
  std::vector<double> table;
  if (random.unit() < kPresets) table = preset_table(count, random);
  if (table.empty()) table = drawn_table(count, random);
  // Sensors look down more than up.
  const double shift_deg = between(random, -12.0, 3.0);
  const double middle_deg = 0.5 * (table.front() + table.back());
  const bool is_centred = std::fabs(middle_deg) < 1e-9;
  for (double& elevation : table) elevation += is_centred ? shift_deg : 0.15 * shift_deg;
  RowSelection rows{count.stride - 1, count.stride};
  if (random.unit() < 0.4 && any_offset) rows.offset = static_cast<int>(random.below(count.stride));
  DrawnBeams beams = with_rows(all, with_rows_between(table, rows));
  beams.measured_rows = rows;
  beams.column_step = random.unit() < 0.5 ? 1 : 2;
  if (random.unit() < kShortSighted) {
    beams.sensor.max_range_m *= between(random, 0.3, 1.0);
  }
  beams.sensor.columns = all.columns / beams.column_step;
  return beams;
}

DrawnBeams beams_like(const SensorModel& all, const SensorModel& sensor,
                      RowSelection measured_rows) {
  std::vector<double> elevation_deg;
  for (const double elevation : sensor.beam_elevation_rad) {
    elevation_deg.push_back(degrees(elevation));
  }
  DrawnBeams beams = with_rows(all, elevation_deg);
  beams.measured_rows = measured_rows;
  if (all.columns % sensor.columns != 0) {
    throw Error("training: scans of {} columns for a sensor of {}, expected a multiple",
                all.columns, sensor.columns);
  }
  beams.column_step = all.columns / sensor.columns;
  beams.sensor.columns = sensor.columns;
  return beams;
}

TrainingScan seen_by(const DrawnBeams& beams, const TrainingScan& scan) {
  TrainingScan seen{RangeImage(beams.sensor.rows(), beams.sensor.columns)};
  const auto farthest_m = static_cast<float>(beams.sensor.max_range_m);
  for (int row = 0; row < seen.truth.rows; ++row) {
    for (int column = 0; column < seen.truth.columns; ++column) {
      const float range_m = scan.truth.at(beams.rows[row], column * beams.column_step);
      seen.truth.at(row, column) = range_m <= farthest_m ? range_m : 0.0F;
    }
  }
  return seen;
}

}  // namespace hqslam::nn
