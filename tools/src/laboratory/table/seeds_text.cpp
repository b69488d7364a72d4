#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "files/content_hash.h"
#include "laboratory/table/table_output.h"

namespace hqslam::tools {
namespace {

constexpr const char* kNothing = "-";

/// "0.0391 [0.0350, 0.0432]"
std::string estimate_text(const Estimate& estimate, int decimals) {
  if (!std::isfinite(estimate.value)) return kNothing;
  std::string text = fmt::format("{:.{}f}", estimate.value, decimals);
  if (std::isfinite(estimate.low) && std::isfinite(estimate.high)) {
    text += fmt::format(" [{:.{}f}, {:.{}f}]", estimate.low, decimals, estimate.high, decimals);
  }
  return text;
}

std::string estimate_text(const std::optional<Estimate>& estimate, int decimals) {
  return estimate ? estimate_text(*estimate, decimals) : kNothing;
}

}  // namespace

TextTable seeds_summary_table(const SeedTable& table) {
  TextTable text;
  text.title = "Drift, slips and position error";
  text.columns = {
      "Method", "drift, %",         "drift, deg/100 m", "drift where it does not slip, %",
      "slips",  "slips per 100 km", "APE, m",           "SLAM, ms"};
  for (std::size_t i = 0; i < table.methods.size(); ++i) {
    const SeedSummary summary = summary_of(table, i);
    text.rows.push_back({table.methods[i].title, estimate_text(summary.drift_percent, 4),
                         estimate_text(summary.drift_deg_per_100m, 4),
                         estimate_text(summary.drift_percent_no_slip, 4),
                         fmt::format("{}", summary.slips),
                         estimate_text(summary.slips_per_100_km, 0),
                         estimate_text(summary.ape_m, 3), fmt::format("{:.1f}", summary.slam_ms)});
  }
  return text;
}

TextTable seeds_pair_table(const SeedTable& table) {
  TextTable text;
  text.title = fmt::format("Drive by drive against {}", table.methods[table.against].title);
  text.columns = {"Method",
                  "drift, difference in %",
                  "drift, ratio",
                  "ratio where neither slips",
                  "slips per 100 km, difference",
                  "share of LiDAR-16's gap to LiDAR-64 closed, drift",
                  "slips"};
  for (std::size_t i = 0; i < table.methods.size(); ++i) {
    const SeedPair pair = pair_of(table, i);
    const bool itself = i == table.against;
    const auto unless_itself = [&](const Estimate& estimate, int decimals) {
      return itself ? kNothing : estimate_text(estimate, decimals);
    };
    text.rows.push_back({table.methods[i].title, unless_itself(pair.drift_difference_percent, 4),
                         unless_itself(pair.drift_ratio, 2),
                         unless_itself(pair.drift_ratio_no_slip, 2),
                         unless_itself(pair.slips_difference, 0), estimate_text(pair.gap_closed, 2),
                         estimate_text(pair.slip_gap_closed, 2)});
  }
  return text;
}

std::string seeds_text(const SeedTable& table) {
  std::string text;
  for (const std::string& name : drive_names(table)) {
    std::vector<std::uint64_t> seeds;
    double path_m = 0.0;
    for (const SeedDrive& drive : of_drive(table, name).drives) {
      seeds.push_back(drive.seed);
      path_m += drive.path_m;
    }
    text += fmt::format("{}{}: seeds {}; {} scans each, {:.1f} km in all", text.empty() ? "" : "; ",
                        name, fmt::join(seeds, ", "), of_drive(table, name).drives.front().scans,
                        1e-3 * path_m);
  }
  return text;
}

std::vector<std::string> seeds_notes(const SeedTable& table) {
  return {
      fmt::format(
          "Every method saw the same {} simulated drives, without loop closing; errors are against "
          "the truth. [ , ]: 95 % interval, bootstrap over drives (10,000 draws, percentiles). An "
          "interval of differences that leaves out 0, or of ratios that leaves out 1, speaks for a "
          "difference.",
          table.drives.size()),
      fmt::format("Drift: mean error of the motion over pieces of {:.0f} m, one from every scan, "
                  "as in KITTI's odometry benchmark; mean over drives.",
                  kDriftPiece_m),
      ("Slips: places where the motion over ten scans is wrong by more than 0.3 m or 0.3 degrees; "
       "scans that follow one another are one slip. Where it does not slip: pieces that share no "
       "scan with a slip."),
      ("Share of the gap closed: (LiDAR-16 - method) / (LiDAR-16 - LiDAR-64); 1 is as good as "
       "LiDAR-64. It means little where the two hardly differ."),
      ("APE: absolute pose error, RMSE of the position after an SE(3) alignment. SLAM, ms: mean "
       "per "
       "scan with one thread, drives beside each other where there were several threads."),
      fmt::format("Made by build {} of the program.", result_sources_hash())};
}

std::string seeds_markdown(const SeedTable& table) {
  std::string text;
  const auto add = [&](const SeedTable& part, const std::string& title) {
    text += fmt::format("## {}\n\n{}\n\n", title, seeds_text(part));
    for (const TextTable& of_part : {seeds_summary_table(part), seeds_pair_table(part)}) {
      text += fmt::format("### {}\n\n{}\n", of_part.title, markdown_of(of_part));
    }
  };
  const std::vector<std::string> names = drive_names(table);
  if (names.size() > 1) add(table, "All drives");
  for (const std::string& name : names) add(of_drive(table, name), name);
  text += "## Notes\n\n";
  for (const std::string& note : seeds_notes(table)) text += fmt::format("- {}\n", note);
  return text;
}

}  // namespace hqslam::tools
