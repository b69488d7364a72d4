#include <nlohmann/json.hpp>

#include "files/content_hash.h"
#include "laboratory/table/table_output.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

Json estimate_json(const Estimate& estimate) {
  return {{"value", estimate.value}, {"low", estimate.low}, {"high", estimate.high}};
}

Json estimate_json(const std::optional<Estimate>& estimate) {
  return estimate ? estimate_json(*estimate) : Json();
}

Json summary_json(const SeedTable& table, std::size_t method) {
  const SeedSummary summary = summary_of(table, method);
  const SeedPair pair = pair_of(table, method);
  return {{"drift_percent", estimate_json(summary.drift_percent)},
          {"drift_deg_per_100m", estimate_json(summary.drift_deg_per_100m)},
          {"drift_percent_no_slip", estimate_json(summary.drift_percent_no_slip)},
          {"slips", summary.slips},
          {"slips_per_100_km", estimate_json(summary.slips_per_100_km)},
          {"ape_m", estimate_json(summary.ape_m)},
          {"drift_difference_percent", estimate_json(pair.drift_difference_percent)},
          {"drift_ratio", estimate_json(pair.drift_ratio)},
          {"drift_ratio_no_slip", estimate_json(pair.drift_ratio_no_slip)},
          {"slips_difference_per_100_km", estimate_json(pair.slips_difference)},
          {"gap_closed", estimate_json(pair.gap_closed)},
          {"slip_gap_closed", estimate_json(pair.slip_gap_closed)},
          {"slam_ms", summary.slam_ms}};
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

Json drive_json(const SeedTable& table, const SeedDrive& drive) {
  Json json = {{"drive", drive.drive},
               {"seed", drive.seed},
               {"scans", drive.scans},
               {"path_m", drive.path_m},
               {"methods", Json::object()}};
  for (std::size_t i = 0; i < table.methods.size(); ++i) {
    const Drift whole = drift(drive.runs[i].pieces);
    json["methods"][table.methods[i].name] = {{"drift_percent", whole.translation_percent},
                                              {"drift_deg_per_100m", whole.rotation_deg_per_100m},
                                              {"pieces", whole.pieces},
                                              {"ape_m", drive.runs[i].ape_m},
                                              {"slips", slips_json(drive.runs[i].slips)}};
  }
  return json;
}

}  // namespace

std::string seeds_json(const SeedTable& table) {
  Json json = {{"written_by", kTableJsonMarker},
               {"build", result_sources_hash()},
               {"against", table.methods[table.against].name},
               {"methods", Json::array()},
               {"drives", Json::array()}};
  for (std::size_t i = 0; i < table.methods.size(); ++i) {
    Json method = {{"method", table.methods[i].name}, {"title", table.methods[i].title}};
    method["all"] = summary_json(table, i);
    for (const std::string& name : drive_names(table)) {
      method[name] = summary_json(of_drive(table, name), i);
    }
    json["methods"].push_back(std::move(method));
  }
  for (const SeedDrive& drive : table.drives) json["drives"].push_back(drive_json(table, drive));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace hqslam::tools
