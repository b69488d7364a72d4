#include "compare/comparison_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pages/text_table.h"

namespace hqslam::tools {
namespace {

using S = UpsamplingScore;

/// A table of figures, with the definitions of its columns.
struct ScoreTable {
  std::vector<Figure<S>> figures;
  std::vector<ColumnDefinition> definitions;
};

/// The score that others are divided by: linear's, or the first where linear is not there.
UpsamplingScore linear_of(const std::vector<UpsamplingScore>& scores) {
  const auto found = std::ranges::find(scores, "linear", &S::method);
  return found != scores.end() ? *found : scores.front();
}

ScoreTable range_table(const UpsamplingScore& linear) {
  const double linear_m = linear.mae_all_m;
  return {{{"MAE all", "mae_all_m", 3, 1.0, &S::mae_all_m},
           {"of linear", nullptr, 3, 1.0, [=](const S& s) { return s.mae_all_m / linear_m; }},
           {"MAE valid", "mae_valid_m", 3, 1.0, &S::mae_valid_m},
           {"missing", "missing_share", 2, 100.0, &S::missing_share},
           {"invented", "invented_share", 2, 100.0, &S::invented_share},
           {"right", "right_share", 2, 100.0, &S::right_share}},
          {{"MAE all", "m, mean |range - true range| of all pixels; no return counts as 0"},
           {"of linear", "MAE all divided by that of linear"},
           {"MAE valid", "m, the mean where both have a return"},
           {"missing", "%, computed pixels left empty, of those with a true return"},
           {"invented", "%, computed returns where the truth has none, of all computed"},
           {"right", "%, computed pixels within 0.1 m, of those with a true return"}}};
}

ScoreTable point_table(const UpsamplingScore& linear) {
  const double linear_count = linear.outliers_per_scan;
  return {{{"Chamfer", "chamfer_m2", 3, 1.0, &S::chamfer_m2},
           {"outliers", "outlier_share", 2, 100.0, &S::outlier_share},
           {"per scan", "outliers_per_scan", 0, 1.0, &S::outliers_per_scan},
           {"of linear", nullptr, 3, 1.0,
            [=](const S& s) { return s.outliers_per_scan / linear_count; }},
           {"time", nullptr, 2, 1.0,
            [](const S& s) {
              return s.upsampling_ms > 0.0 ? std::optional(s.upsampling_ms) : std::nullopt;
            }},
           {nullptr, "upsampling_ms", 0, 1.0, &S::upsampling_ms}},
          {{"Chamfer", "m^2, mean squared distance between the clouds, both ways summed"},
           {"outliers", "%, points farther than 0.5 m from the true cloud, of all points"},
           {"per scan", "number of outliers in a scan"},
           {"of linear", "outliers per scan divided by those of linear"},
           {"time", "ms, median time to upsample a scan"}}};
}

ScoreTable voxel_table() {
  return {{{"IoU", "iou", 3, 1.0, &S::iou},
           {"precision", "precision", 3, 1.0, &S::precision},
           {"recall", "recall", 3, 1.0, &S::recall},
           {"F1", "f1", 3, 1.0, &S::f1},
           {"F1 computed", "computed_f1", 3, 1.0, &S::computed_f1}},
          {{"IoU", "voxels of 0.1 m that both clouds fill, of those that either fills"},
           {"precision", "voxels that both fill, of those that the upsampled cloud fills"},
           {"recall", "voxels that both fill, of those that the true cloud fills"},
           {"F1", "harmonic mean of precision and recall"},
           {"F1 computed", "F1 without the measured rows"}}};
}

}  // namespace

std::string scores_text(const std::vector<UpsamplingScore>& scores) {
  const UpsamplingScore linear = linear_of(scores);
  std::string text;
  const auto add = [&](const char* names, const ScoreTable& table) {
    const auto method = [](const S& score) { return score.method; };
    text += printed_table(table_of(scores, names, table.figures, method)) + "\n" +
            printed_definitions(table.definitions) + "\n";
  };
  add("Ranges", range_table(linear));
  add("Points", point_table(linear));
  add("Voxels", voxel_table());
  return text;
}

nlohmann::ordered_json scores_json(const std::vector<UpsamplingScore>& scores) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const UpsamplingScore& score : scores) {
    auto& row = json.emplace_back(nlohmann::ordered_json{{"method", score.method}});
    for (const ScoreTable& table : {range_table(score), point_table(score), voxel_table()}) {
      add_figures(score, table.figures, row);
    }
  }
  return json;
}

}  // namespace hqslam::tools
