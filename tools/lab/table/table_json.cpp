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

void add_estimates(const MethodStatistics& method, const std::vector<StatisticsColumn>& columns,
                   Json& json) {
  for (const StatisticsColumn& column : columns) {
    if (column.key == nullptr) continue;
    const std::optional<Estimate> e = column.of(method);
    json[column.key] = e ? Json{{"value", e->value}, {"low", e->low}, {"high", e->high}} : Json();
  }
}

Json summary_json(const MethodStatistics& method) {
  Json json;
  add_estimates(method, summary_columns(), json);
  json["slips"] = method.slips;
  add_estimates(method, pair_columns(), json);
  json["slam_ms"] = method.slam_ms;
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

Json drive_json(const TableSample& sample, const DriveSample& drive) {
  Json json = {{"drive", drive.drive},
               {"seed", drive.seed},
               {"scans", drive.scans},
               {"path_m", drive.path_m},
               {"methods", Json::object()}};
  for (std::size_t i = 0; i < sample.methods.size(); ++i) {
    const MethodSample& method = drive.methods[i];
    const Drift whole = drift(method.pieces);
    const auto where_any = [&](double value) { return whole.pieces > 0 ? Json(value) : Json(); };
    json["methods"][sample.methods[i].name] = {
        {"drift_percent", where_any(whole.translation_percent)},
        {"drift_deg_per_100m", where_any(whole.rotation_deg_per_100m)},
        {"pieces", whole.pieces},
        {"ape_m", method.ape_m},
        {"slips", slips_json(method.slips)}};
  }
  return json;
}

/// Lengths in metres, to the millimetre.
Json lengths_json(const std::vector<double>& lengths_m) {
  Json json = Json::array();
  for (const double length_m : lengths_m) json.push_back(1e-3 * std::round(1e3 * length_m));
  return json;
}

Json error_map_json(const ErrorMap& map) {
  Json json = {
      {"title", map.title},
      {"reference",
       {{"x_m", lengths_json(map.reference_x_m)}, {"y_m", lengths_json(map.reference_y_m)}}},
      {"paths", Json::array()}};
  for (const ErrorPath& path : map.paths) {
    json["paths"].push_back({{"name", path.method},
                             {"rmse_m", path.rmse_m},
                             {"x_m", lengths_json(path.x_m)},
                             {"y_m", lengths_json(path.y_m)},
                             {"distance_m", lengths_json(path.distance_m)},
                             {"error_m", lengths_json(path.error_m)}});
  }
  return json;
}

Json paired_drift_json(const PairedDrift& drift) {
  return {{"name", drift.method},
          {"dots", drift.differences_percent},
          {"mean", drift.mean_percent.value},
          {"low", drift.mean_percent.low},
          {"high", drift.mean_percent.high}};
}

template <typename Value, typename Writer>
Json list_json(const std::vector<Value>& values, const Writer& writer) {
  Json json = Json::array();
  for (const Value& value : values) json.push_back(writer(value));
  return json;
}

Json part_json(const ReportPart& part) {
  return {{"title", part.title},
          {"text", part.text},
          {"tables", list_json(part.tables, [](const TextTable& table) { return json_of(table); })},
          {"error_maps", list_json(part.error_maps, error_map_json)},
          {"paired_with", part.paired_with},
          {"paired_drifts", list_json(part.paired_drifts, paired_drift_json)}};
}

std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Json page_data(const TableReport& report) {
  return {{"title", report.title},
          {"lead", list_json(report.lead, [](const TextTable& table) { return json_of(table); })},
          {"parts", list_json(report.parts, part_json)},
          {"notes", report.notes}};
}

std::string drives_json(const std::vector<DriveFigures>& drives) {
  Json json = {{"written_by", "hqslam-lab table"},
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
  return text_of(json);
}

std::string statistics_json(const std::vector<PartStatistics>& parts) {
  const TableSample& sample = parts.front().sample;
  Json json = {{"written_by", "hqslam-lab table"},
               {"build", result_sources_hash()},
               {"against", sample.methods[sample.against].name},
               {"methods", Json::array()},
               {"drives", Json::array()}};
  for (std::size_t i = 0; i < sample.methods.size(); ++i) {
    Json method = {{"method", sample.methods[i].name}, {"title", sample.methods[i].title}};
    for (const PartStatistics& part : parts) method[part.name] = summary_json(part.methods[i]);
    json["methods"].push_back(std::move(method));
  }
  for (const DriveSample& drive : sample.drives)
    json["drives"].push_back(drive_json(sample, drive));
  return text_of(json);
}

}  // namespace hqslam::tools
