#include "table/table_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "pages/text_table.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

/// "0.0391 [0.0350, 0.0432]"
std::string estimate_text(const Estimate& estimate, int decimals) {
  if (!std::isfinite(estimate.value)) return kNoFigure;
  std::string text = fmt::format("{:.{}f}", estimate.value, decimals);
  if (std::isfinite(estimate.low) && std::isfinite(estimate.high)) {
    text += fmt::format(" [{:.{}f}, {:.{}f}]", estimate.low, decimals, estimate.high, decimals);
  }
  return text;
}

/// Adds a table of these columns, with a row per method, to the texts and to the JSON.
void add_columns(const std::string& title, const std::vector<StatisticsColumn>& columns,
                 PartReport& report) {
  const TableSample& sample = report.part.sample;
  TextTable& table = report.tables.emplace_back(TextTable{.title = title, .columns = {"Method"}});
  for (const StatisticsColumn& column : columns) table.columns.emplace_back(column.column);
  for (std::size_t method = 0; method < sample.methods.size(); ++method) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(sample.methods[method].title);
    for (const StatisticsColumn& column : columns) {
      const Estimate e = column.of(sample, method);
      const bool is_shown = !(column.of_others && method == sample.against);
      cells.push_back(is_shown ? estimate_text(e, column.decimals) : kNoFigure);
      report.methods[sample.methods[method].name][column.key] = {
          {"value", e.value}, {"low", e.low}, {"high", e.high}};
    }
  }
}

/// "town: seeds 1, 2, 3; 1000 scans each, 2.7 km in all", "town: seed 4; 300 scans, 221 m"
std::string text_of(const TableSample& sample, const std::string& kind) {
  const TableSample part = of_kind(sample, kind);
  const bool is_one = part.drives.size() == 1;
  std::vector<std::uint64_t> seeds;
  double all_m = 0.0;
  std::int64_t left_out = 0;
  for (const DriveErrors& drive : part.drives) {
    if (drive.seed) seeds.push_back(*drive.seed);
    all_m += drive.path_m();
    left_out += drive.scans_left_out;
  }
  std::string text = kind + ": ";
  if (!seeds.empty()) text += fmt::format("seed{} {}; ", is_one ? "" : "s", fmt::join(seeds, ", "));
  text += fmt::format("{} scans{}", part.drives.front().scans, is_one ? "" : " each");
  if (left_out > 0) text += fmt::format(", of which {} were left out", left_out);
  return text + (is_one ? fmt::format(", {:.0f} m", all_m)
                        : fmt::format(", {:.1f} km in all", 1e-3 * all_m));
}

std::vector<std::string> notes() {
  return {
      "Every method ran on the same scans, without loop closing. [ , ]: 95 % interval, bootstrap "
      "over drives (10,000 draws, percentiles). An interval of differences without 0, or of ratios "
      "without 1, is evidence of a difference.",
      fmt::format("Drift: mean error of the motion over pieces of {:.0f} m, one from every scan, "
                  "as in KITTI's odometry benchmark; mean over drives.",
                  kDriftPiece_m),
      "Slips: places where the motion over ten scans is wrong by more than 0.3 m or 0.3 degrees; "
      "successive scans are one slip. Drift where it does not slip: over pieces that share no scan "
      "with a slip.",
      "Share of the gap closed, drift: (LiDAR-16 - method) / (LiDAR-16 - LiDAR-64); 1 is as good "
      "as LiDAR-64. It is unreliable where the two hardly differ.",
      "APE: absolute pose error, RMSE of the position after an SE(3) alignment. Against LiDAR-64: "
      "against the trajectory of the same SLAM with all 64 rows, which has errors of its own.",
      fmt::format("Made by program {}.", program_hash())};
}

std::string title_of(const PartReport& report) {
  return report.part.name == kAllDrives ? "All drives" : report.part.name;
}

Json map_json(const TablePart& part) {
  const ErrorMap& map = part.map;
  Json json = {{"reference", {{"name", part.reference}, {"x_m", map.x_m}, {"y_m", map.y_m}}},
               {"paths", Json::array()}};
  for (const ErrorPath& path : map.paths) {
    json["paths"].push_back({{"name", path.method},
                             {"rmse_m", path.rmse_m},
                             {"x_m", path.x_m},
                             {"y_m", path.y_m},
                             {"distance_m", path.distance_m},
                             {"error_m", path.error_m}});
  }
  return json;
}

/// The drift of each other method minus that of the one that it is paired with, %, with a dot per
/// drive.
Json paired_drifts_json(const PartReport& report) {
  const TableSample& sample = report.part.sample;
  Json drifts = Json::array();
  for (std::size_t method = 0; method < sample.methods.size(); ++method) {
    if (method == sample.against) continue;
    const Json& mean = report.methods[sample.methods[method].name][pair_columns().front().key];
    drifts.push_back({{"name", sample.methods[method].title},
                      {"dots", drift_differences_percent(sample, method)},
                      {"mean", mean["value"]},
                      {"low", mean["low"]},
                      {"high", mean["high"]}});
  }
  return drifts;
}

Json errors_json(const TrajectoryErrors& errors) {
  const Drift whole = drift(errors.pieces);
  const auto where_any = [&](double value) { return whole.pieces > 0 ? Json(value) : Json(); };
  Json json = {{"drift_percent", where_any(whole.translation_percent)},
               {"drift_deg_per_100m", where_any(whole.rotation_deg_per_100m)},
               {"pieces", whole.pieces},
               {"ape_m", errors.ape_rmse_m},
               {"slips", Json::array()}};
  for (const Slip& slip : errors.slips) {
    json["slips"].push_back({{"first_scan", slip.first},
                             {"last_scan", slip.last},
                             {"translation_m", slip.translation_m},
                             {"rotation_rad", slip.rotation_rad}});
  }
  return json;
}

Json drive_json(const DriveErrors& drive, const TablePart& part) {
  Json json = {{"drive", drive.kind},
               {"seed", drive.seed ? Json(*drive.seed) : Json()},
               {"against", part.reference},
               {"scans", drive.scans},
               {"scans_left_out", drive.scans_left_out},
               {"path_m", drive.path_m()},
               {"methods", Json::object()}};
  for (std::size_t i = 0; i < drive.methods.size(); ++i) {
    json["methods"][part.sample.methods[i].name] = errors_json(drive.methods[i]);
  }
  return json;
}

}  // namespace

PartReport report_of(const TablePart& part) {
  PartReport report{part, "", {}, Json::object()};
  for (const std::string& kind : kinds_of(part.sample)) {
    report.text += (report.text.empty() ? "" : "; ") + text_of(part.sample, kind);
  }
  report.text += "; errors are against " + part.reference;
  add_columns("Drift, slips and position error", summary_columns(), report);
  const std::string& paired_with = part.sample.methods[part.sample.against].title;
  add_columns("Drive by drive against " + paired_with, pair_columns(), report);
  return report;
}

std::string printed(const std::vector<PartReport>& parts) {
  std::string text;
  for (const PartReport& report : parts) {
    text += fmt::format("{}\n{}\n\n", title_of(report), report.text);
    for (const TextTable& table : report.tables) {
      text += fmt::format("{}\n\n{}\n", table.title, printed_table(table));
    }
    if (report.part.name == kAllDrives) break;
  }
  return text;
}

std::string markdown_of(const std::vector<PartReport>& parts) {
  std::string text;
  for (const PartReport& report : parts) {
    text += fmt::format("## {}\n\n{}\n\n", title_of(report), report.text);
    for (const TextTable& table : report.tables) {
      text += fmt::format("### {}\n\n{}\n", table.title, markdown_of(table));
    }
  }
  return text + fmt::format("## Notes\n\n- {}\n", fmt::join(notes(), "\n- "));
}

Json page_data(const std::vector<PartReport>& parts) {
  Json data = {{"title", "One SLAM, several inputs"}, {"parts", Json::array()}, {"notes", notes()}};
  for (const PartReport& report : parts) {
    const TableSample& sample = report.part.sample;
    data["parts"].push_back({{"title", title_of(report)},
                             {"text", report.text},
                             {"tables", {json_of(report.tables[0]), json_of(report.tables[1])}},
                             {"error_map", map_json(report.part)},
                             {"paired_with", sample.methods[sample.against].title},
                             {"paired_drifts", paired_drifts_json(report)}});
  }
  return data;
}

std::string json_of(const std::vector<PartReport>& parts) {
  const TableSample& first = parts.front().part.sample;
  Json json = {{"written_by", "hqslam-lab table"},
               {"program", program_hash()},
               {"against", first.methods[first.against].name},
               {"methods", Json::array()},
               {"drives", Json::array()}};
  for (const TableMethod& method : first.methods) {
    Json& figures =
        json["methods"].emplace_back(Json{{"method", method.name}, {"title", method.title}});
    for (const PartReport& report : parts) {
      figures[report.part.name] = report.methods[method.name];
    }
  }
  const bool has_all = parts.front().part.name == kAllDrives;  // which the others are parts of
  for (const PartReport& report : has_all ? std::vector{parts.front()} : parts) {
    for (const DriveErrors& drive : report.part.sample.drives) {
      json["drives"].push_back(drive_json(drive, report.part));
    }
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace hqslam::tools
