#include <fmt/format.h>

#include <cmath>

#include "table/table_report.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

/// In metres, to the millimetre.
double to_millimetre(double length_m) { return 1e-3 * std::round(1e3 * length_m); }

void add_place(const StampedPose& pose, Json& path) {
  path["x_m"].push_back(to_millimetre(pose.T_map_sensor.translation().x()));
  path["y_m"].push_back(to_millimetre(pose.T_map_sensor.translation().y()));
}

/// Every how many poses are kept.
std::size_t step_of(std::size_t poses) { return (poses + kMostPathPoses - 1) / kMostPathPoses; }

/// The path of a method with its errors; `reference`: LiDAR-64's trajectory.
Json path_of(const std::string& title, const AbsolutePoseError& ape, const Trajectory& reference) {
  Json path = {{"name", title}, {"rmse_m", ape.translation_statistics.rmse}};
  for (const char* list : {"x_m", "y_m", "distance_m", "error_m"}) path[list] = Json::array();
  const std::size_t poses = ape.pairs.reference.size();
  const auto position_m = [&](std::size_t pair) -> Eigen::Vector3d {
    return reference[ape.pairs.reference[pair]].T_map_sensor.translation();
  };
  double distance_m = 0.0;
  for (std::size_t i = 0; i < poses; ++i) {
    if (i > 0) distance_m += (position_m(i) - position_m(i - 1)).norm();
    if (i % step_of(poses) != 0) continue;
    add_place(ape.aligned_estimate[ape.pairs.estimate[i]], path);
    path["distance_m"].push_back(to_millimetre(distance_m));
    path["error_m"].push_back(to_millimetre(ape.translation_m[i]));
  }
  return path;
}

}  // namespace

Json error_map_of(const DriveFigures& drive, std::size_t loop_closing) {
  Json map = {{"title", fmt::format("loop closing {}", kLoopClosingNames[loop_closing])},
              {"reference", {{"x_m", Json::array()}, {"y_m", Json::array()}}},
              {"paths", Json::array()}};
  const TableResult* all_rows = find_method(drive, table_methods().back().name);
  if (all_rows == nullptr) return map;
  const Trajectory& reference = all_rows->trajectory[loop_closing];
  for (std::size_t i = 0; i < reference.size(); i += step_of(reference.size())) {
    add_place(reference[i], map["reference"]);
  }
  for (const TableResult& figures : drive.methods) {
    const auto& error = figures.against_all_rows[loop_closing];
    if (error) map["paths"].push_back(path_of(figures.method.title, error->ape, reference));
  }
  return map;
}

}  // namespace hqslam::tools
