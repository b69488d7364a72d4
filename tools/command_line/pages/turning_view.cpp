#include "pages/turning_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "hqslam/core/median.h"
#include "pages/page.h"
#include "pages/point_blocks.h"

namespace hqslam::tools {

namespace {

using Json = nlohmann::ordered_json;
using Points = std::vector<Eigen::Vector3f>;

/// To millimetres.
Json rounded(double value) { return std::round(value * 1e3) / 1e3; }
Json json_of(const Eigen::Vector3d& place_m) {
  return {rounded(place_m.x()), rounded(place_m.y()), rounded(place_m.z())};
}
Json json_of(const Eigen::Vector3f& place_m) {
  return json_of(Eigen::Vector3d(place_m.cast<double>()));
}

/// From the dimmest to the brightest of the points, but for the few beyond; nothing where no
/// intensity is known.
std::vector<float> range_of_intensities(std::vector<float> intensity) {
  constexpr double kBeyond = 0.02;
  std::erase_if(intensity, [](float value) { return !std::isfinite(value); });
  if (intensity.empty()) return {};
  const auto at = [&](double share) {
    const auto place =
        intensity.begin() + std::lround(share * static_cast<double>(intensity.size() - 1));
    std::nth_element(intensity.begin(), place, intensity.end());
    return *place;
  };
  return {at(kBeyond), at(1.0 - kBeyond)};
}

Json json_of(const ViewCloud& cloud, std::size_t most_points) {
  const std::vector<float> bright = range_of_intensities(cloud.intensity);
  std::vector<float> brightness;
  if (!bright.empty()) {
    for (const float intensity : cloud.intensity) {
      brightness.push_back((intensity - bright[0]) / std::max(bright[1] - bright[0], 1e-6F));
    }
  }
  const PointBlocks packed =
      point_blocks(cloud.points_m, cloud.confidence, most_points, brightness);
  Json blocks = Json::array();
  for (const PointBlocks::Block& block : packed.blocks) {
    Json& entry = blocks.emplace_back(Json{block.corner.x(), block.corner.y(), block.corner.z()});
    for (const std::uint32_t end : block.ends) entry.push_back(end);
  }
  std::vector<std::uint8_t> bytes(packed.points.size() * sizeof(std::uint32_t));
  if (!bytes.empty()) std::memcpy(bytes.data(), packed.points.data(), bytes.size());
  return {{"name", cloud.name},
          {"sure", !cloud.confidence.empty()},
          {"bright", bright},
          {"brightness", base64(packed.brightness)},
          {"origin", json_of(packed.origin_m)},
          {"step", packed.step_m},
          {"spacing", packed.spacing_m},
          {"blocks", std::move(blocks)},
          {"points", base64(bytes)}};
}

/// The coordinates of an axis between which all points are but a share of them at either end.
std::array<double, 2> range_of(const std::vector<Eigen::Vector3f>& points_m, int axis,
                               double share) {
  std::vector<float> values;
  for (const Eigen::Vector3f& point_m : points_m) {
    if (point_m.allFinite()) values.push_back(point_m[axis]);
  }
  if (values.empty()) return {0.0, 1.0};
  const double low = quantile(values, share);
  return {low, quantile(values, 1.0 - share)};
}

/// The heights between which colours change: all but those of a few points, at least 1 m.
std::array<double, 2> range_of_heights(const std::vector<Eigen::Vector3f>& points_m) {
  const auto [low_m, high_m] = range_of(points_m, 2, 0.01);
  return {low_m, std::max(low_m + 1.0, high_m)};
}

/// How much of the room each cloud gets, so that none has less than its part of it unless it needs
/// less.
std::vector<std::size_t> shared_out(std::size_t room, const std::vector<std::size_t>& wanted) {
  std::vector<std::size_t> by_size(wanted.size());
  std::iota(by_size.begin(), by_size.end(), 0U);
  std::ranges::sort(by_size, {}, [&](std::size_t i) { return wanted[i]; });
  std::vector<std::size_t> result(wanted.size());
  std::size_t left = wanted.size();
  for (const std::size_t i : by_size) {
    result[i] = std::min(wanted[i], room / left--);
    room -= result[i];
  }
  return result;
}

/// Around the paths, or where there is none around most of the points, or the grid.
Eigen::AlignedBox3d scene_of(const TurningView& view, const Points& points_m) {
  constexpr double kAroundPath_m = 15.0;
  Eigen::AlignedBox3d box;
  for (const ViewPath& path : view.paths) {
    for (const Points& piece_m : path.pieces_m) {
      for (const Eigen::Vector3f& place_m : piece_m) box.extend(place_m.cast<double>());
    }
  }
  if (!box.isEmpty()) {
    const Eigen::Vector3d margin_m(kAroundPath_m, kAroundPath_m, 0.0);
    return {box.min() - margin_m, box.max() + margin_m};
  }
  if (points_m.empty() && view.grid) {
    const auto& [cell_m, origin_m, rows, columns, cells] = view.grid->map;
    return {Eigen::Vector3d(origin_m.x(), origin_m.y(), 0.0),
            Eigen::Vector3d(origin_m.x() + columns * cell_m, origin_m.y() + rows * cell_m, 0.0)};
  }
  constexpr double kOutliers = 0.05;
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto range = range_of(points_m, axis, kOutliers);
    low[axis] = range[0];
    high[axis] = range[1];
  }
  return {low, high};
}

Json json_of(const ViewScan& scan) {
  const Eigen::Vector3d ahead = scan.T_map_sensor.linear().col(0);
  return {{"name", scan.name},
          {"at", json_of(Eigen::Vector3d(scan.T_map_sensor.translation()))},
          {"yaw", std::atan2(ahead.y(), ahead.x())},
          {"measured", json_of(scan.measured, scan.measured.points_m.size())}};
}

Json json_of(const ViewPath& path) {
  Json pieces = Json::array();
  for (const Points& piece_m : path.pieces_m) {
    Json& piece = pieces.emplace_back(Json::array());
    for (const Eigen::Vector3f& place_m : piece_m) piece.push_back(json_of(place_m));
  }
  return {{"name", path.name}, {"pieces", std::move(pieces)}};
}

/// Cells of two bits, four in a byte, the first in the lowest.
Json json_of(const ViewGrid& grid) {
  const slam::OccupancyMap map = thinned(grid.map);
  std::vector<std::uint8_t> packed((map.cells.size() + 3) / 4, 0);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    packed[i / 4] |= static_cast<std::uint8_t>(static_cast<unsigned>(map.cells[i]) << 2 * (i % 4));
  }
  return {{"rows", map.rows},           {"columns", map.columns},
          {"cell_m", map.resolution_m}, {"origin_m", {map.origin_m.x(), map.origin_m.y()}},
          {"summary", grid.summary},    {"cells", u8_block(packed)}};
}

}  // namespace

slam::OccupancyMap thinned(const slam::OccupancyMap& map, std::size_t most_cells) {
  int factor = 1;
  const auto side = [&](int cells) { return (cells + factor - 1) / factor; };
  while (static_cast<std::size_t>(side(map.rows)) * side(map.columns) > most_cells) ++factor;
  slam::OccupancyMap result = map;
  if (factor == 1) return result;
  result.resolution_m = factor * map.resolution_m;
  result.rows = side(map.rows);
  result.columns = side(map.columns);
  // Row 0 has the largest y: the lower edge moves down where rows do not divide.
  result.origin_m.y() -= (result.rows * factor - map.rows) * map.resolution_m;
  result.cells.assign(static_cast<std::size_t>(result.rows) * result.columns,
                      slam::Occupancy::kUnknown);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      slam::Occupancy& cell =
          result.cells[static_cast<std::size_t>(row / factor) * result.columns + column / factor];
      cell = std::max(cell, map.cells[static_cast<std::size_t>(row) * map.columns + column]);
    }
  }
  return result;
}

Json turning_view_json(const TurningView& view) {
  static const Points kNone;
  const Points& points_m = view.clouds.empty() ? kNone : view.clouds.front().points_m;
  const Eigen::AlignedBox3d scene = scene_of(view, points_m);
  Json data = {{"centre", json_of(Eigen::Vector3d(scene.center()))},
               {"radius", std::max(5.0, 0.5 * scene.sizes().head<2>().norm())},
               {"heights", range_of_heights(points_m)}};
  const auto bytes_of_point = [](const ViewCloud& cloud) {
    return sizeof(std::uint32_t) + (cloud.intensity.empty() ? 0 : 1);
  };
  std::vector<std::size_t> wanted;
  for (const ViewCloud& cloud : view.clouds) {
    wanted.push_back(cloud.points_m.size() * bytes_of_point(cloud));
  }
  const std::vector<std::size_t> most =
      shared_out(kMostCloudPoints * sizeof(std::uint32_t), wanted);
  data["clouds"] = Json::array();
  for (std::size_t i = 0; i < most.size(); ++i) {
    const ViewCloud& cloud = view.clouds[i];
    data["clouds"].push_back(json_of(cloud, most[i] / bytes_of_point(cloud)));
  }
  data["paths"] = Json::array();
  for (const ViewPath& path : view.paths) data["paths"].push_back(json_of(path));
  data["loops"] = Json::array();
  for (const auto& [from_m, to_m] : view.loops_m) {
    data["loops"].push_back({json_of(from_m), json_of(to_m)});
  }
  data["scans"] = Json::array();
  if (view.last_scan) data["scans"].push_back(json_of(*view.last_scan));
  if (!view.drive.scans.empty()) data["drive"] = drive_json(view.drive);
  if (view.grid) data["grid"] = json_of(*view.grid);
  return data;
}

}  // namespace hqslam::tools
