#include "table/table_result.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "files/content_hash.h"
#include "files/text_file.h"
#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kWrittenBy = "hqslam table";

std::string json_path(const std::string& method, const std::string& folder) {
  return (fs::path(folder) / (method + ".json")).string();
}

std::string trajectory_path(const std::string& method, std::size_t loop_closing,
                            const std::string& folder) {
  return (fs::path(folder) /
          fmt::format("{}-loop-closing-{}.tum", method, kLoopClosingNames[loop_closing]))
      .string();
}

/// Loop closing off, and on where it was asked for.
std::size_t trajectories_of(const TableSettings& settings) { return settings.loop_closing ? 2 : 1; }

Json settings_json(const TableSettings& settings) {
  return {{"build", settings.build},
          {"recording", settings.recording},
          {"sensor", settings.sensor},
          {"scans", settings.scans},
          {"loop_closing", settings.loop_closing},
          {"method", settings.method},
          {"weights", settings.weights},
          {"weights_hash", settings.weights_hash}};
}

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json images_json(const std::optional<ImageScores>& images) {
  if (!images) return {};
  return {{"scans", images->scans},
          {"mae_all_m", images->mae_all_m},
          {"mae_valid_m", images->mae_valid_m},
          {"outlier_share", images->outlier_share}};
}

Json network_json(const std::optional<NetworkSize>& network) {
  if (!network) return {};
  return {{"parameters", network->parameters}, {"multiply_adds", network->multiply_adds}};
}

Json timings_json(const TableTimings& timings) {
  Json json = {{"threads", timings.threads},
               {"processor", timings.processor},
               {"instruction_set", timings.instruction_set},
               {"upsampling_s", timings.upsampling_s},
               {"upsampling_ms", timings.upsampling_ms},
               {"points_s", timings.points_s}};
  for (std::size_t i = 0; i < timings.slam.size(); ++i) {
    json["slam"].push_back({{"total_s", timings.slam[i].total_s},
                            {"first_ms", optional_json(timings.slam[i].first_ms)},
                            {"last_ms", optional_json(timings.slam[i].last_ms)}});
  }
  return json;
}

std::optional<double> optional_from(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

std::optional<ImageScores> images_from(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return ImageScores{json.at("scans"), json.at("mae_all_m"), json.at("mae_valid_m"),
                     json.at("outlier_share")};
}

std::optional<NetworkSize> network_from(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return NetworkSize{json.at("parameters"), json.at("multiply_adds")};
}

TableTimings timings_from(const Json& json) {
  TableTimings timings;
  timings.threads = json.at("threads");
  timings.processor = json.at("processor");
  timings.instruction_set = json.at("instruction_set");
  timings.upsampling_s = json.at("upsampling_s");
  timings.upsampling_ms = json.at("upsampling_ms");
  timings.points_s = json.at("points_s");
  for (std::size_t i = 0; i < timings.slam.size(); ++i) {
    const Json& slam = json.at("slam").at(i);
    timings.slam[i] = {slam.at("total_s"), optional_from(slam.at("first_ms")),
                       optional_from(slam.at("last_ms"))};
  }
  return timings;
}

/// Throws Error or Json::exception for files that are not what save_result wrote.
std::optional<TableResult> read_result(const TableSettings& settings, const std::string& folder) {
  std::ifstream stream(json_path(settings.method, folder));
  const Json json = Json::parse(stream);
  if (json.at("written_by") != kWrittenBy || json.at("settings") != settings_json(settings)) {
    return std::nullopt;
  }
  TableResult result;
  result.settings = settings;
  const Json& figures = json.at("result");
  result.images = images_from(figures.at("images"));
  result.network = network_from(figures.at("network"));
  result.loops_closed = figures.at("loops_closed");
  result.left_out = {figures.at("scans_left_out"), figures.at("first_left_out")};
  result.timings = timings_from(json.at("timings"));
  for (std::size_t i = 0; i < trajectories_of(settings); ++i) {
    const std::string path = trajectory_path(settings.method, i, folder);
    if (content_hash(path) != figures.at("trajectory_hash").at(i)) return std::nullopt;
    result.trajectory[i] = read_tum(path);
  }
  return result;
}

}  // namespace

void save_result(const TableResult& result, const std::string& folder) {
  std::error_code ignored;
  fs::create_directories(folder, ignored);  // writing says what is wrong
  const std::string& method = result.settings.method;
  Json hashes;
  for (std::size_t i = 0; i < trajectories_of(result.settings); ++i) {
    const std::string path = trajectory_path(method, i, folder);
    write_tum(result.trajectory[i], path);
    hashes.push_back(content_hash(path));
  }
  const Json json = {{"written_by", kWrittenBy},
                     {"settings", settings_json(result.settings)},
                     {"result",
                      {{"images", images_json(result.images)},
                       {"network", network_json(result.network)},
                       {"loops_closed", result.loops_closed},
                       {"scans_left_out", result.left_out.scans},
                       {"first_left_out", result.left_out.first},
                       {"trajectory_hash", hashes}}},
                     {"timings", timings_json(result.timings)}};
  // The trajectories first: a result counts as there when this file and their hashes agree.
  write_text_file(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
                  json_path(method, folder));
}

std::optional<TableResult> load_result(const TableSettings& settings, const std::string& folder) {
  try {
    return read_result(settings, folder);
  } catch (const Error&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace hqslam::tools
