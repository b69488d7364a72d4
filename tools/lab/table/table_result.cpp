#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "files/content_hash.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "table/table_figures.h"

/// nothing is null
template <typename Value>
struct nlohmann::adl_serializer<std::optional<Value>> {
  static void to_json(nlohmann::json& json, const std::optional<Value>& value) {
    json = value ? nlohmann::json(*value) : nullptr;
  }
  static void from_json(const nlohmann::json& json, std::optional<Value>& value) {
    value = json.is_null() ? std::nullopt : std::optional(json.get<Value>());
  }
};

namespace hqslam {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LeftOut, scans, first)
}  // namespace hqslam

namespace hqslam::tools {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TableSettings, build, recording, sensor, scans, loop_closing,
                                   method, weights, weights_hash)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ImageScores, scans, mae_all_m, mae_valid_m, outlier_share)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(NetworkSize, parameters, multiply_adds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SlamTimings, total_s, first_ms, last_ms)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TableTimings, threads, processor, instruction_set, upsampling_s,
                                   upsampling_ms, points_s, slam)
// What is the same in every run; trajectories have files of their own.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TableResult, images, network, loops_closed, scan_of_pose,
                                   left_out)

namespace {

namespace fs = std::filesystem;
using SortedJson = nlohmann::json;

constexpr const char* kWrittenBy = "hqslam-lab table";

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

/// Throws Error or SortedJson::exception for files that are not what save_result wrote.
std::optional<TableResult> read_result(const TableSettings& settings, const std::string& folder) {
  std::ifstream stream(json_path(settings.method, folder));
  const SortedJson json = SortedJson::parse(stream);
  if (json.at("written_by") != kWrittenBy || json.at("settings") != SortedJson(settings)) {
    return std::nullopt;
  }
  const SortedJson& figures = json.at("result");
  TableResult result = figures.get<TableResult>();
  result.settings = settings;
  json.at("timings").get_to(result.timings);
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
  fs::create_directories(folder, ignored);  // the writer reports errors
  const std::string& method = result.settings.method;
  SortedJson figures = result;
  for (std::size_t i = 0; i < trajectories_of(result.settings); ++i) {
    const std::string path = trajectory_path(method, i, folder);
    write_tum(result.trajectory[i], path);
    figures["trajectory_hash"].push_back(content_hash(path));
  }
  const SortedJson json = {{"written_by", kWrittenBy},
                           {"settings", result.settings},
                           {"result", figures},
                           {"timings", result.timings}};
  // The trajectories come first: a result exists once this file has their hashes.
  write_text_file(json.dump(2, ' ', false, SortedJson::error_handler_t::replace) + "\n",
                  json_path(method, folder));
}

std::optional<TableResult> load_result(const TableSettings& settings, const std::string& folder) {
  try {
    return read_result(settings, folder);
  } catch (const Error&) {
    return std::nullopt;
  } catch (const SortedJson::exception&) {
    return std::nullopt;
  }
}

}  // namespace hqslam::tools
