#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/evaluation/png.h"
#include "report/chart.h"
#include "report/cloud_picture.h"
#include "report/page.h"
#include "run/run_output.h"

namespace hqslam::tools {
namespace {

constexpr double kLeastMargin_m = 12.0;
constexpr double kMarginShare = 0.06;
constexpr double kWidestAspect = 2.4;  ///< width over height
constexpr double kTallestAspect = 1.3;
constexpr double kFewestImageColumns = 200.0;
constexpr double kMostImageColumns = 900.0;
constexpr double kImagePixel_m = 0.2;  // the map is thinned to this: smaller pixels show gaps

/// Everything drawn, in the map frame.
struct Drawing {
  std::vector<Eigen::Vector2d> estimate_m;
  std::vector<std::optional<double>> error_m;  ///< per pose of the estimate
  std::vector<bool> is_way_known;              ///< from each pose to the next
  double largest_error_m = 0.0;
  std::vector<Eigen::Vector2d> reference_m;
};

Drawing drawing_of(const SlamRun& run) {
  Drawing drawing;
  for (const StampedPose& pose : run.trajectory) {
    drawing.estimate_m.push_back(pose.T_map_sensor.translation().head<2>());
  }
  for (std::size_t i = 0; i + 1 < run.trajectory.size(); ++i) {
    drawing.is_way_known.push_back(is_way_known(run, i));
  }
  drawing.error_m.resize(run.trajectory.size());
  if (!run.comparison || run.trajectory.empty()) return drawing;
  const AbsolutePoseError& error = run.comparison->error;
  for (std::size_t i = 0; i < error.translation_m.size(); ++i) {
    drawing.error_m[error.pairs.estimate[i]] = error.translation_m[i];
  }
  drawing.largest_error_m = error.translation_statistics.max;
  // The alignment moved the estimate onto the reference; its inverse brings the reference here.
  const Pose T_map_reference =
      run.trajectory.front().T_map_sensor * error.aligned_estimate.front().T_map_sensor.inverse();
  for (const StampedPose& pose : run.comparison->reference) {
    drawing.reference_m.push_back((T_map_reference * pose.T_map_sensor).translation().head<2>());
  }
  return drawing;
}

/// Widens the shorter side until the plot is neither a strip nor a tower.
void limit_aspect(PlotBox& box) {
  const double width = box.x_max - box.x_min;
  const double height = box.y_max - box.y_min;
  const double more_height = 0.5 * std::max(0.0, width / kWidestAspect - height);
  const double more_width = 0.5 * std::max(0.0, height * kTallestAspect - width);
  box.x_min -= more_width;
  box.x_max += more_width;
  box.y_min -= more_height;
  box.y_max += more_height;
}

PlotBox box_around(const Drawing& drawing) {
  Eigen::AlignedBox2d bounds;
  for (const Eigen::Vector2d& point_m : drawing.estimate_m) bounds.extend(point_m);
  for (const Eigen::Vector2d& point_m : drawing.reference_m) bounds.extend(point_m);
  if (bounds.isEmpty()) bounds.extend(Eigen::Vector2d::Zero());
  const double margin_m = std::max(kLeastMargin_m, kMarginShare * bounds.sizes().maxCoeff());
  PlotBox box{bounds.min().x() - margin_m, bounds.max().x() + margin_m, bounds.min().y() - margin_m,
              bounds.max().y() + margin_m};
  limit_aspect(box);
  return box;
}

std::string point_text(const PlotBox& box, const Eigen::Vector2d& point_m) {
  return fmt::format("{:.1f},{:.1f}", to_plot_x(box, point_m.x()), to_plot_y(box, point_m.y()));
}

std::string reference_svg(const PlotBox& box, const Drawing& drawing) {
  std::string path;
  for (const Eigen::Vector2d& point_m : drawing.reference_m) {
    path += path.empty() ? 'M' : 'L';
    path += point_text(box, point_m);
  }
  return path.empty() ? "" : fmt::format("<path class=\"line reference\" d=\"{}\"/>\n", path);
}

/// The colour class of the stretch between two poses, nothing where an error is not known.
std::optional<int> color_of(const Drawing& drawing, std::size_t from) {
  const std::optional<double>& a = drawing.error_m[from];
  const std::optional<double>& b = drawing.error_m[from + 1];
  if (!a || !b || drawing.largest_error_m <= 0.0) return std::nullopt;
  return error_color_class(0.5 * (*a + *b) / drawing.largest_error_m);
}

/// One path per run of stretches of the same colour; none where nothing is known about the way.
std::string estimate_svg(const PlotBox& box, const Drawing& drawing) {
  std::string svg;
  const std::size_t poses = drawing.estimate_m.size();
  for (std::size_t i = 0; i + 1 < poses;) {
    if (!drawing.is_way_known[i]) {
      ++i;
      continue;
    }
    const std::optional<int> color = color_of(drawing, i);
    std::string path = fmt::format("M{}", point_text(box, drawing.estimate_m[i]));
    std::size_t end = i;
    while (end + 1 < poses && drawing.is_way_known[end] && color_of(drawing, end) == color) {
      ++end;
      path += 'L';
      path += point_text(box, drawing.estimate_m[end]);
    }
    const std::string style =
        color ? fmt::format(" style=\"stroke:{}\"", error_color_of_class(*color)) : "";
    svg += fmt::format("<path class=\"line estimate\"{} d=\"{}\"/>\n", style, path);
    i = end;
  }
  return svg;
}

std::string mark_html(const PlotBox& box, const Eigen::Vector2d& point_m, std::string_view name) {
  return fmt::format("<span class=\"mark {}\" style=\"left:{:.2f}%;top:{:.2f}%\"><b>{}</b></span>",
                     name, 100.0 * to_plot_x(box, point_m.x()) / kPlotUnits,
                     100.0 * to_plot_y(box, point_m.y()) / kPlotUnits, name);
}

std::string marks_html(const PlotBox& box, const Drawing& drawing) {
  if (drawing.estimate_m.empty()) return "";
  return mark_html(box, drawing.estimate_m.front(), "start") +
         mark_html(box, drawing.estimate_m.back(), "end");
}

std::string map_html(const PlotBox& box, const SlamRun& run) {
  if (run.map_points_m.empty()) return "";
  const double aspect = (box.x_max - box.x_min) / (box.y_max - box.y_min);
  const double columns =
      std::clamp((box.x_max - box.x_min) / kImagePixel_m, kFewestImageColumns, kMostImageColumns);
  const RgbImage image =
      density_from_above(run.map_points_m, box, static_cast<int>(std::lround(columns / aspect)),
                         static_cast<int>(std::lround(columns)));
  return fmt::format("<img class=\"map\" alt=\"\" src=\"{}\">", picture_source(image));
}

std::string legend_html(const Drawing& drawing) {
  if (drawing.reference_m.empty()) return "";
  return fmt::format(
      "<ul class=\"legend\"><li><i class=\"reference-sample\"></i>reference</li>"
      "<li>estimate, error 0<i class=\"scale\" style=\"background:linear-gradient(90deg, {})\"></i>"
      "{:.3f} m</li></ul>\n",
      error_gradient(), drawing.largest_error_m);
}

}  // namespace

std::string trajectory_plot_html(const SlamRun& run) {
  const Drawing drawing = drawing_of(run);
  const PlotBox box = box_around(drawing);
  const double width_m = box.x_max - box.x_min;
  const double height_m = box.y_max - box.y_min;
  const double step_m = tick_step(width_m, 7);
  const PlotGrid grid = plot_grid(box, ticks_within(box.x_min, box.x_max, step_m),
                                  ticks_within(box.y_min, box.y_max, step_m));
  return fmt::format(
      "{}<p class=\"axis\">y, m</p>\n"
      "<div class=\"plot\" style=\"aspect-ratio:{:.4f}\">{}"
      "<svg viewBox=\"0 0 1000 1000\" preserveAspectRatio=\"none\" role=\"img\" "
      "aria-label=\"Trajectory from above\">\n{}{}{}</svg>{}{}</div>\n"
      "<p class=\"axis below\">x, m</p>\n",
      legend_html(drawing), width_m / height_m, map_html(box, run), grid.svg,
      reference_svg(box, drawing), estimate_svg(box, drawing), grid.labels_html,
      marks_html(box, drawing));
}

}  // namespace hqslam::tools
