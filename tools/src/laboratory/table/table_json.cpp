#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "laboratory/table/table_output.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json error_json(const std::optional<ErrorFigures>& error) {
  if (!error) return {};
  return {{"ape_rmse_m", error->ape_rmse_m()},
          {"path_m", error->path_m},
          {"poses", error->ape.translation_m.size()},
          {"rpe_percent", optional_json(error->rpe_percent)},
          {"rpe_deg_per_100m", optional_json(error->rpe_deg_per_100m)}};
}

Json method_json(const MethodFigures& figures) {
  Json json = {{"method", figures.method.name}, {"title", figures.method.title}};
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    json[fmt::format("loop_closing_{}", kLoopClosingNames[i])] = {
        {"against_lidar_64", error_json(figures.against_all_rows[i])},
        {"against_truth", error_json(figures.against_truth[i])}};
  }
  json["loops_closed"] = figures.result.loops_closed;
  if (const auto& images = figures.result.images) {
    json["images"] = {{"scans", images->scans},
                      {"mae_all_m", images->mae_all_m},
                      {"mae_valid_m", images->mae_valid_m},
                      {"outlier_share", images->outlier_share}};
  }
  if (const auto& network = figures.result.network) {
    json["parameters"] = network->parameters;
    json["multiply_adds"] = network->multiply_adds;
    json["weights_hash"] = figures.result.settings.weights_hash;
  }
  return json;
}

Json method_timings_json(const MethodFigures& figures) {
  const TableTimings& timings = figures.result.timings;
  Json json = {{"method", figures.method.name},
               {"threads", timings.threads},
               {"processor", timings.processor},
               {"instruction_set", timings.instruction_set},
               {"upsampling_frames_per_second", optional_json(figures.upsampling_fps())}};
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    json[fmt::format("loop_closing_{}", kLoopClosingNames[i])] = {
        {"chain_frames_per_second", figures.chain_fps(i)},
        {"slam_first_500_ms", optional_json(timings.slam[i].first_ms)},
        {"slam_last_500_ms", optional_json(timings.slam[i].last_ms)}};
  }
  return json;
}

}  // namespace

std::string table_json(const std::vector<DriveFigures>& drives) {
  Json json = {{"written_by", kTableJsonMarker},
               {"alignment", name(Alignment::kSe3)},
               {"drives", Json::array()}};
  Json timings = Json::array();
  for (const DriveFigures& drive : drives) {
    Json methods = Json::array();
    Json method_timings = Json::array();
    for (const MethodFigures& figures : drive.methods) {
      methods.push_back(method_json(figures));
      method_timings.push_back(method_timings_json(figures));
    }
    json["drives"].push_back({{"name", drive.name},
                              {"sensor", drive.sensor},
                              {"scans", drive.scans},
                              {"scans_left_out", drive.left_out.scans},
                              {"methods", std::move(methods)}});
    timings.push_back({{"name", drive.name}, {"methods", std::move(method_timings)}});
  }
  json["timings"] = std::move(timings);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace hqslam::tools
