#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "table/result_sources_hash.h"
#include "table/table_report.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json error_json(const std::optional<ErrorFigures>& error) {
  if (!error) return {};
  return {{"ape_rmse_m", error->ape_rmse_m()},
          {"path_m", error->path_m},
          {"poses", error->ape.translation_m.size()},
          {"rpe_percent", optional_json(error->rpe_percent())},
          {"rpe_deg_per_100m", optional_json(error->rpe_deg_per_100m())}};
}

Json method_json(const TableResult& figures) {
  Json json = {{"method", figures.method.name}, {"title", figures.method.title}};
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    json[fmt::format("loop_closing_{}", kLoopClosingNames[i])] = {
        {"against_lidar_64", error_json(figures.against_all_rows[i])},
        {"against_truth", error_json(figures.against_truth[i])}};
  }
  json["loops_closed"] = figures.loops_closed;
  if (const auto& images = figures.images) {
    json["images"] = {{"scans", images->scans},
                      {"mae_all_m", images->mae_all_m},
                      {"mae_valid_m", images->mae_valid_m},
                      {"outlier_share", images->outlier_share}};
  }
  if (const auto& network = figures.network) {
    json["parameters"] = network->parameters;
    json["multiply_adds"] = network->multiply_adds;
    json["weights_hash"] = figures.settings.weights_hash;
  }
  return json;
}

Json method_timings_json(const TableResult& figures) {
  const TableTimings& timings = figures.timings;
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

void add_estimates(const std::vector<StatisticsColumn>& columns,
                   const std::vector<std::optional<Estimate>>& estimates, Json& json) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].key == nullptr) continue;
    const std::optional<Estimate>& e = estimates[i];
    json[columns[i].key] =
        e ? Json{{"value", e->value}, {"low", e->low}, {"high", e->high}} : Json();
  }
}

Json summary_json(const PartStatistics& part, std::size_t method) {
  Json json;
  add_estimates(summary_columns(), part.summary[method], json);
  json["slips"] = slips_of(part.sample, method);
  add_estimates(pair_columns(), part.pairs[method], json);
  json["slam_ms"] = slam_ms_of(part.sample, method);
  return json;
}

Json slips_json(const std::vector<Slip>& slips) {
  Json json = Json::array();
  for (const Slip& slip : slips) {
    json.push_back({{"first_scan", slip.first},
                    {"last_scan", slip.last},
                    {"translation_m", slip.translation_m},
                    {"rotation_rad", slip.rotation_rad}});
  }
  return json;
}

Json drive_json(const DriveFigures& drive) {
  Json json = {{"drive", drive.kind},
               {"seed", drive.seed},
               {"scans", drive.scans},
               {"path_m", path_m(drive)},
               {"methods", Json::object()}};
  for (std::size_t i = 0; i < drive.methods.size(); ++i) {
    const TableResult& figures = drive.methods[i];
    const ErrorFigures& errors = errors_of(drive, i);
    const Drift whole = drift(errors.pieces);
    const auto where_any = [&](double value) { return whole.pieces > 0 ? Json(value) : Json(); };
    json["methods"][figures.method.name] = {
        {"drift_percent", where_any(whole.translation_percent)},
        {"drift_deg_per_100m", where_any(whole.rotation_deg_per_100m)},
        {"pieces", whole.pieces},
        {"ape_m", errors.ape_rmse_m()},
        {"slips", slips_json(figures.slips)}};
  }
  return json;
}

std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string drives_json(const std::vector<DriveFigures>& drives) {
  Json json = {{"written_by", "hqslam-lab table"},
               {"alignment", name(Alignment::kSe3)},
               {"drives", Json::array()}};
  Json timings = Json::array();
  for (const DriveFigures& drive : drives) {
    Json methods = Json::array();
    Json method_timings = Json::array();
    for (const TableResult& figures : drive.methods) {
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
  return text_of(json);
}

std::string statistics_json(const std::vector<PartStatistics>& parts) {
  const TableSample& sample = parts.front().sample;
  Json json = {{"written_by", "hqslam-lab table"},
               {"build", result_sources_hash()},
               {"against", sample.methods()[sample.against].method.name},
               {"methods", Json::array()},
               {"drives", Json::array()}};
  for (std::size_t i = 0; i < sample.methods().size(); ++i) {
    const TableMethod& method = sample.methods()[i].method;
    Json& figures =
        json["methods"].emplace_back(Json{{"method", method.name}, {"title", method.title}});
    for (const PartStatistics& part : parts) figures[part.name] = summary_json(part, i);
  }
  for (const DriveFigures* drive : sample.drives) json["drives"].push_back(drive_json(*drive));
  return text_of(json);
}

}  // namespace hqslam::tools
