#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

#include "hqslam/core/error.h"
#include "hqslam/core/median.h"
#include "points/sensor_finder.h"

namespace hqslam::recordings {

namespace {

/// Places in a recording from which two scans each are read.
constexpr std::size_t kPlaces = 5;
/// More points than ten scans of any LiDAR have, as in a map.
constexpr std::size_t kMostPoints = 5'000'000;
/// Longer than a turn of any LiDAR.
constexpr double kLongestTurn_s = 1.0;
/// Stamps farther apart are taken for those of several turns: sensors at five turns a second, whose
/// scans have times, are rarer than recordings of which every second scan was left out.
constexpr double kFarthestStamps_s = 0.15;

std::set<std::size_t> scans_to_look_at(std::size_t scans) {
  std::set<std::size_t> indices;
  for (std::size_t place = 0; place < kPlaces; ++place) {
    const std::size_t first = place * (scans - 1) / kPlaces;
    indices.insert({first, std::min(first + 1, scans - 1)});
  }
  return indices;
}

/// Most steps from stamp to stamp are one turn, and so is the time from a scan's first point to its
/// last.
std::optional<double> period_of(std::vector<double> turns_s, double longest_s) {
  std::erase_if(turns_s, [&](double turn_s) { return !(turn_s > 0.01 && turn_s < longest_s); });
  if (turns_s.empty()) return std::nullopt;
  return std::round(1e4 * median(turns_s)) * 1e-4;
}

}  // namespace

FoundSensor find_sensor_of_files(const std::vector<std::string>& paths,
                                 const std::vector<double>& stamps_s) {
  std::vector<RawPoints> scans;
  std::vector<double> stamp_steps_s, lasted_s;
  std::exception_ptr unreadable;
  std::size_t points = 0;
  for (const std::size_t i : scans_to_look_at(paths.size())) {
    try {
      scans.push_back(read_point_file(paths[i]));
    } catch (const Error&) {
      unreadable = std::current_exception();
      continue;
    }
    points += scans.back().scan.points_m.size();
    if (points > kMostPoints) break;
    const auto times = usable_times(scans.back().time, kLongestTurn_s);
    if (times) lasted_s.push_back(times->duration_s);
  }
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    stamp_steps_s.push_back(stamps_s[i] - stamps_s[i - 1]);
  }
  if (scans.empty() && unreadable) std::rethrow_exception(unreadable);
  const auto by_stamps_s = period_of(std::move(stamp_steps_s), kFarthestStamps_s);
  const auto by_times_s = period_of(std::move(lasted_s), kLongestTurn_s);
  return find_sensor(scans, by_stamps_s ? by_stamps_s : by_times_s, paths.front());
}

}  // namespace hqslam::recordings
