#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "hqslam/core/error.h"
#include "report/chart.h"
#include "table/table_report.h"

namespace hqslam::tools {
namespace {

constexpr double kPanelWidth = 480.0;
constexpr double kNarrowestAspect = 0.8;  ///< width over height
constexpr double kWidestAspect = 2.0;
constexpr double kMarginShare = 0.12;
constexpr double kLeastMargin_m = 3.0;
constexpr double kMostOverMedian = 3.0;
constexpr double kGap = 20.0;
constexpr double kTitleHeight = 40.0;
constexpr double kPanelTitleHeight = 56.0;
constexpr double kScaleHeight = 74.0;
constexpr const char* kQuiet = "#666d78";
constexpr const char* kReference = "#c4c9d0";

/// What every panel shows: the reference with a margin, metres.
PlotBox box_of(const ErrorMap& map) {
  Eigen::AlignedBox2d bounds;
  for (const Eigen::Vector2d& point_m : map.reference_m) bounds.extend(point_m);
  const Eigen::Vector2d center_m = bounds.center();
  const double margin_m = std::max(kLeastMargin_m, kMarginShare * bounds.sizes().maxCoeff());
  Eigen::Vector2d size_m = bounds.sizes() + Eigen::Vector2d::Constant(2.0 * margin_m);
  size_m.x() = std::max(size_m.x(), kNarrowestAspect * size_m.y());
  size_m.y() = std::max(size_m.y(), size_m.x() / kWidestAspect);
  return {center_m.x() - 0.5 * size_m.x(), center_m.x() + 0.5 * size_m.x(),
          center_m.y() - 0.5 * size_m.y(), center_m.y() + 0.5 * size_m.y()};
}

/// Where a point of the drive lies in a panel.
struct View {
  PlotBox box;

  double height() const { return kPanelWidth * (box.y_max - box.y_min) / (box.x_max - box.x_min); }
  Eigen::Vector2d operator()(const Eigen::Vector2d& point_m) const {
    return {kPanelWidth * to_plot_x(box, point_m.x()) / kPlotUnits,
            height() * to_plot_y(box, point_m.y()) / kPlotUnits};
  }
};

std::string path_svg(const std::vector<Eigen::Vector2d>& points, const std::string& color,
                     double width) {
  std::string text;
  for (const Eigen::Vector2d& point : points) {
    text += fmt::format("{}{:.1f} {:.1f}", text.empty() ? 'M' : 'L', point.x(), point.y());
  }
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
      "stroke-linecap=\"round\" stroke-linejoin=\"round\"/>\n",
      text, color, width);
}

/// A point of a path as it is drawn, and the mean error on the way to it.
struct Step {
  Eigen::Vector2d at;
  double error_m;
};

/// In steps of some pixels: nobody sees more, and a long drive has thousands of poses.
std::vector<Step> steps_of(const std::vector<Eigen::Vector2d>& path_m,
                           const std::vector<double>& error_m, const View& view) {
  constexpr double kStep = 3.0;
  std::vector<Step> steps;
  double sum_m = 0.0;
  std::size_t from = 0;
  for (std::size_t i = 0; i < path_m.size(); ++i) {
    const Eigen::Vector2d at = view(path_m[i]);
    if (i > 0 && !error_m.empty()) sum_m += error_m[i];
    const bool moved = steps.empty() || (at - steps.back().at).norm() >= kStep;
    if (!moved && i + 1 < path_m.size()) continue;
    steps.push_back({at, i > from ? sum_m / static_cast<double>(i - from) : 0.0});
    from = i;
    sum_m = 0.0;
  }
  return steps;
}

/// One path per run of steps of the same colour.
std::string trajectory_svg(const ErrorPanel& panel, const ErrorScale& scale, const View& view) {
  const std::vector<Step> steps = steps_of(panel.path_m, panel.error_m, view);
  const auto class_of = [&](const Step& step) {
    return error_color_class(scale.top_m > 0.0 ? step.error_m / scale.top_m : 0.0);
  };
  std::string svg;
  for (std::size_t i = 1; i < steps.size();) {
    const int color = class_of(steps[i]);
    std::vector<Eigen::Vector2d> run = {steps[i - 1].at};
    for (; i < steps.size() && class_of(steps[i]) == color; ++i) run.push_back(steps[i].at);
    svg += path_svg(run, error_color_of_class(color), 3.5);
  }
  return svg;
}

std::string text_svg(const std::string& text, double x, double y, double size,
                     const std::string& more = "") {
  return fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" font-size=\"{}\"{}>{}</text>\n", x, y, size,
                     more, escape_html(text));
}

std::string scale_bar_svg(const View& view) {
  const double width_m = view.box.x_max - view.box.x_min;
  const double length_m = tick_step(width_m, 5);
  const double y = view.height() - 14.0;
  return path_svg({{14.0, y}, {14.0 + kPanelWidth * length_m / width_m, y}}, kQuiet, 2.0) +
         text_svg(tick_text(length_m) + " m", 14.0, y - 7.0, 11.0,
                  fmt::format(" fill=\"{}\"", kQuiet));
}

/// `place`: where it stands in another SVG, as attributes.
std::string panel_at(const ErrorMap& map, const ErrorPanel& panel, const ErrorScale& scale,
                     const std::string& place) {
  const View view{box_of(map)};
  std::vector<Eigen::Vector2d> reference;
  for (const Step& step : steps_of(map.reference_m, {}, view)) reference.push_back(step.at);
  std::string svg = fmt::format(
      "<svg{} role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {:.0f} {:.0f}\" "
      "font-family=\"sans-serif\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#f6f7f9\"/>\n",
      place, escape_html(panel.title), kPanelWidth, view.height());
  svg += path_svg(reference, kReference, 2.0) + trajectory_svg(panel, scale, view);
  if (!panel.path_m.empty()) {
    const Eigen::Vector2d start = view(panel.path_m.front());
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\" fill=\"none\" stroke=\"#1c1f24\" "
        "stroke-width=\"1.5\"/>\n",
        start.x(), start.y());
  }
  return svg + scale_bar_svg(view) + "</svg>\n";
}

/// Colours from 0 to the scale's top with both ends written below.
std::string color_bar_svg(const ErrorScale& scale, double left, double top) {
  constexpr double kWidth = 320.0;
  constexpr double kHeight = 14.0;
  std::string svg = text_svg("distance from LiDAR-64, aligned", left, top - 8.0, 12.0);
  for (int i = 0; i < kErrorColors; ++i) {
    svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n",
                       left + kWidth * i / kErrorColors, top, kWidth / kErrorColors, kHeight,
                       error_color_of_class(i));
  }
  const double below = top + kHeight + 20.0;
  svg += text_svg("0", left, below, 12.0) +
         text_svg(top_text(scale), left + kWidth - 40.0, below, 12.0);
  const double line_left = left + kWidth + 190.0;
  const double line = top + 0.5 * kHeight;
  return svg + path_svg({{line_left, line}, {line_left + 50.0, line}}, kReference, 2.0) +
         text_svg("LiDAR-64, ring: the start", line_left + 62.0, line + 6.0, 12.0);
}

/// As many columns as make neither a strip nor a tower.
int grid_columns(std::size_t panels) {
  return panels <= 4 ? static_cast<int>(panels) : panels <= 6 ? 3 : 4;
}

}  // namespace

ErrorScale error_scale(const ErrorMap& map) {
  std::vector<double> largest_m;
  for (const ErrorPanel& panel : map.panels) {
    if (!panel.error_m.empty()) {
      largest_m.push_back(*std::ranges::max_element(panel.error_m));
    }
  }
  if (largest_m.empty()) return {};
  std::ranges::sort(largest_m);
  const double limit_m = kMostOverMedian * largest_m[(largest_m.size() - 1) / 2];
  return {std::min(largest_m.back(), limit_m), largest_m.back() > limit_m};
}

std::string top_text(const ErrorScale& scale) {
  return fmt::format("{:.{}f} m{}", scale.top_m, scale.top_m < 10.0 ? 2 : 0,
                     scale.clipped ? " or more" : "");
}

std::string error_text(const ErrorPanel& panel) {
  const double largest_m = panel.error_m.empty() ? 0.0 : *std::ranges::max_element(panel.error_m);
  return fmt::format("RMSE {:.3f}, largest {:.2f} m", panel.rmse_m, largest_m);
}

std::string panel_svg(const ErrorMap& map, std::size_t panel, const ErrorScale& scale) {
  return panel_at(map, map.panels[panel], scale, "");
}

std::string error_map_svg(const ErrorMap& map, const std::string& title) {
  if (map.panels.empty()) throw Error("error map: expected at least one trajectory, found none");
  const ErrorScale scale = error_scale(map);
  const double panel_height = View{box_of(map)}.height();
  const int columns = grid_columns(map.panels.size());
  const int rows = (static_cast<int>(map.panels.size()) + columns - 1) / columns;
  const double cell_height = kPanelTitleHeight + panel_height;
  const double width = std::max(kGap + columns * (kPanelWidth + kGap), 800.0);
  const double height = kTitleHeight + rows * cell_height + kScaleHeight + kGap;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" fill=\"#1c1f24\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width, height);
  svg += text_svg(title, kGap, 34.0, 15.0);
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    const int row = static_cast<int>(i) / columns;
    const double left = kGap + static_cast<int>(i) % columns * (kPanelWidth + kGap);
    const double top = kTitleHeight + row * cell_height;
    svg += text_svg(map.panels[i].title, left, top + 46.0, 14.0);
    svg += text_svg(error_text(map.panels[i]), left + kPanelWidth, top + 46.0, 12.0,
                    fmt::format(" text-anchor=\"end\" fill=\"{}\"", kQuiet));
    svg += panel_at(map, map.panels[i], scale,
                    fmt::format(" x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\"",
                                left, top + kPanelTitleHeight, kPanelWidth, panel_height));
  }
  return svg + color_bar_svg(scale, kGap, kTitleHeight + rows * cell_height + 36.0) + "</svg>\n";
}

}  // namespace hqslam::tools
