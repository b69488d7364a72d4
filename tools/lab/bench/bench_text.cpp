#include "bench/bench_text.h"

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <vector>

#include "pages/text_table.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

double number(const Json& measured, const char* pointer) {
  return measured.at(Json::json_pointer(pointer)).get<double>();
}

/// A number of each row, by its JSON pointer; nothing where it, or what has it, is null.
Figure<Json> column(const char* title, int decimals, const char* pointer) {
  const auto of = [path = Json::json_pointer(pointer)](const Json& row) {
    return row.contains(path) && row.at(path).is_number()
               ? std::optional(row.at(path).get<double>())
               : std::nullopt;
  };
  return {title, nullptr, decimals, 1.0, of};
}

std::string table_text(const Json& rows, const char* names,
                       const std::vector<Figure<Json>>& figures,
                       const std::function<std::string(const Json&)>& name) {
  return printed_table(table_of(rows.get_ref<const Json::array_t&>(), names, figures, name));
}

/// "64", or "16, du-mix, memory".
std::string rows_text(const Json& timing) {
  const std::string by = timing["upsampled_by"];
  return fmt::format("{}{}{}", timing["rows"].get<int>(), by.empty() ? "" : ", ", by);
}

std::string slam_text(const Json& slam) {
  const std::vector<Figure<Json>> stages = {
      column("threads", 0, "/threads"),
      column("upsampling", 2, "/upsampling_ms/median"),
      column("segmentation", 2, "/stages_ms/segmentation/median"),
      column("features", 2, "/stages_ms/features/median"),
      column("odometry", 2, "/stages_ms/odometry/median"),
      column("mapping", 2, "/stages_ms/mapping/median")};
  const std::vector<Figure<Json>> totals = {column("threads", 0, "/threads"),
                                            column("scans", 0, "/scans"),
                                            column("median", 2, "/stages_ms/total/median"),
                                            column("95 %", 2, "/stages_ms/total/p95"),
                                            {"scans/s", nullptr, 1, 1.0, [](const Json& row) {
                                               return 1e3 / number(row, "/stages_ms/total/mean");
                                             }}};
  return "SLAM's stages, median ms per scan\n\n" + table_text(slam, "Rows", stages, rows_text) +
         "\nUpsampling and SLAM together, ms per scan\n\n" +
         table_text(slam, "Rows", totals, rows_text) + "\n" +
         printed_definitions(
             {{"Rows", "measured rows, and the method that upsamples them"},
              {"upsampling", "from measured points to points of all rows, with its memory"},
              {"scans/s", "from the mean time"}}) +
         "\n";
}

std::string instruction_set_text(const Json& row) { return row["instruction_set"]; }

std::string runs_text(const Json& runs) {
  return table_text(
      runs, "instructions",
      {column("threads", 0, "/threads"), column("frames", 0, "/frames"),
       column("frames/s", 1, "/frames_per_second"), column("ms/frame", 2, "/frame_ms/median"),
       column("95 %", 2, "/frame_ms/p95"), column("GFLOP/s", 1, "/gflops")},
      instruction_set_text);
}

std::string network_text(const Json& network) {
  const std::string text =
      fmt::format("\n{}: whole network, filter included; {} parameters, {:.3f} GMAC a frame\n",
                  network["network"].get<std::string>(), network["parameters"].get<std::int64_t>(),
                  network["gmac"].get<double>());
  return text + runs_text(network["runs"]);
}

}  // namespace

std::string bench_text(const Json& measured) {
  std::string text =
      fmt::format("{}, sensor {}, {} cores\n\n", measured["input"].get<std::string>(),
                  measured["sensor"].get<std::string>(), measured["cores"].get<int>());
  text += slam_text(measured["slam"]);
  for (const Json& network : measured["networks"]) text += network_text(network);
  return text;
}

}  // namespace hqslam::tools
