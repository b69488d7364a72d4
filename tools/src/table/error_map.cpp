#include "table/error_map.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"
#include "report/canvas.h"
#include "report/chart.h"
#include "run/trajectory_plot.h"

namespace hqslam::tools {
namespace {

constexpr int kPanelColumns = 480;
constexpr double kNarrowestAspect = 0.8;  ///< width over height
constexpr double kWidestAspect = 2.0;
constexpr double kMarginShare = 0.12;
constexpr double kLeastMargin_m = 3.0;
constexpr double kMostOverMedian = 3.0;
constexpr int kGap = 20;
constexpr int kTitleRows = 40;
constexpr int kPanelTitleRows = 56;
constexpr int kScaleRows = 74;
constexpr Rgb kText = {28, 31, 36};
constexpr Rgb kQuiet = {102, 109, 120};
constexpr Rgb kReference = {196, 201, 208};
constexpr Rgb kPanel = {246, 247, 249};

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

int panel_rows(const PlotBox& box) {
  return static_cast<int>(
      std::lround(kPanelColumns * (box.y_max - box.y_min) / (box.x_max - box.x_min)));
}

Rgb color_of(double error_m, const ErrorScale& scale) {
  return error_rgb(scale.top_m > 0.0 ? error_m / scale.top_m : 0.0);
}

/// Where a point of the drive lies in a panel.
struct View {
  PlotBox box;
  PixelBox pixels;
  Eigen::Vector2d operator()(const Eigen::Vector2d& point_m) const {
    return {pixels.left + pixels.columns * to_plot_x(box, point_m.x()) / kPlotUnits,
            pixels.top + pixels.rows * to_plot_y(box, point_m.y()) / kPlotUnits};
  }
};

void draw_scale_bar(Canvas& canvas, const View& view) {
  const double width_m = view.box.x_max - view.box.x_min;
  const double length_m = tick_step(width_m, 5);
  const double length = view.pixels.columns * length_m / width_m;
  const Eigen::Vector2d start(view.pixels.left + 14.0, view.pixels.top + view.pixels.rows - 14.0);
  const Eigen::Vector2d end = start + Eigen::Vector2d(length, 0.0);
  canvas.draw_line({start, end}, 2.0, kQuiet, view.pixels);
  canvas.draw_text(tick_text(length_m) + " m", start - Eigen::Vector2d(0.0, 7.0), 11.0, kQuiet);
}

/// In steps of some pixels: where poses lie closer, edges drawn many times would lose their
/// smoothness. Each step has the colour of its mean error.
void draw_path(Canvas& canvas, const ErrorPanel& panel, const ErrorScale& scale, const View& view) {
  constexpr double kStep = 3.0;
  std::size_t from = 0;
  double sum_m = 0.0;
  for (std::size_t i = 1; i < panel.path_m.size(); ++i) {
    sum_m += panel.error_m[i];
    const Eigen::Vector2d start = view(panel.path_m[from]);
    const Eigen::Vector2d end = view(panel.path_m[i]);
    if ((end - start).norm() < kStep && i + 1 < panel.path_m.size()) continue;
    canvas.draw_line({start, end}, 3.5, color_of(sum_m / static_cast<double>(i - from), scale),
                     view.pixels);
    from = i;
    sum_m = 0.0;
  }
}

/// A ring around the first pose.
void draw_start(Canvas& canvas, const ErrorPanel& panel, const View& view) {
  constexpr double kRadius = 6.0;
  constexpr int kCorners = 24;
  if (panel.path_m.empty()) return;
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i <= kCorners; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kCorners;
    ring.push_back(view(panel.path_m.front()) +
                   kRadius * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  canvas.draw_line(ring, 1.5, kText, view.pixels);
}

void draw_panel(Canvas& canvas, const ErrorMap& map, const ErrorPanel& panel,
                const ErrorScale& scale, const View& view) {
  canvas.fill(view.pixels, kPanel);
  std::vector<Eigen::Vector2d> reference;
  for (const Eigen::Vector2d& point_m : map.reference_m) reference.push_back(view(point_m));
  canvas.draw_line(reference, 2.0, kReference, view.pixels);
  draw_path(canvas, panel, scale, view);
  draw_start(canvas, panel, view);
  draw_scale_bar(canvas, view);
}

/// Colours from 0 to the scale's top with both ends written below.
void draw_color_bar(Canvas& canvas, const ErrorScale& scale, int left, int top) {
  constexpr int kColumns = 320;
  constexpr int kRows = 14;
  canvas.draw_text("distance from LiDAR-64, aligned", {static_cast<double>(left), top - 8.0}, 12.0,
                   kText);
  for (int column = 0; column < kColumns; ++column) {
    canvas.fill({left + column, top, 1, kRows}, error_rgb((column + 0.5) / kColumns));
  }
  const double below = top + kRows + 20.0;
  canvas.draw_text("0", {static_cast<double>(left), below}, 12.0, kText);
  canvas.draw_text(top_text(scale), {left + kColumns - 40.0, below}, 12.0, kText);
  const double line_left = left + kColumns + 190.0;
  const double line = top + 0.5 * kRows;
  canvas.draw_line({{line_left, line}, {line_left + 50.0, line}}, 2.0, kReference, canvas.whole());
  canvas.draw_text("LiDAR-64, ring: the start", {line_left + 62.0, line + 6.0}, 12.0, kText);
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
      largest_m.push_back(*std::max_element(panel.error_m.begin(), panel.error_m.end()));
    }
  }
  if (largest_m.empty()) return {};
  std::sort(largest_m.begin(), largest_m.end());
  const double limit_m = kMostOverMedian * largest_m[(largest_m.size() - 1) / 2];
  return {std::min(largest_m.back(), limit_m), largest_m.back() > limit_m};
}

std::string top_text(const ErrorScale& scale) {
  return fmt::format("{:.{}f} m{}", scale.top_m, scale.top_m < 10.0 ? 2 : 0,
                     scale.clipped ? " or more" : "");
}

std::string error_text(const ErrorPanel& panel) {
  const double largest_m =
      panel.error_m.empty() ? 0.0 : *std::max_element(panel.error_m.begin(), panel.error_m.end());
  return fmt::format("RMSE {:.3f}, largest {:.2f} m", panel.rmse_m, largest_m);
}

RgbImage panel_image(const ErrorMap& map, std::size_t panel, const ErrorScale& scale) {
  const PlotBox box = box_of(map);
  Canvas canvas(panel_rows(box), kPanelColumns);
  draw_panel(canvas, map, map.panels[panel], scale, {box, canvas.whole()});
  return canvas.image();
}

RgbImage error_map_image(const ErrorMap& map, const std::string& title) {
  if (map.panels.empty()) throw Error("error map: expected at least one trajectory, found none");
  const ErrorScale scale = error_scale(map);
  const PlotBox box = box_of(map);
  const int columns = grid_columns(map.panels.size());
  const int rows = (static_cast<int>(map.panels.size()) + columns - 1) / columns;
  const int cell_rows = kPanelTitleRows + panel_rows(box);
  Canvas canvas(kTitleRows + rows * cell_rows + kScaleRows + kGap,
                std::max(kGap + columns * (kPanelColumns + kGap), 800));
  canvas.draw_text(title, {kGap, 34.0}, 15.0, kText);
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    const int left = kGap + static_cast<int>(i) % columns * (kPanelColumns + kGap);
    const int top = kTitleRows + static_cast<int>(i) / columns * cell_rows;
    canvas.draw_text(map.panels[i].title, {static_cast<double>(left), top + 46.0}, 14.0, kText);
    const std::string errors = error_text(map.panels[i]);
    canvas.draw_text(errors, {left + kPanelColumns - text_width(errors, 12.0), top + 46.0}, 12.0,
                     kQuiet);
    draw_panel(canvas, map, map.panels[i], scale,
               {box, {left, top + kPanelTitleRows, kPanelColumns, panel_rows(box)}});
  }
  draw_color_bar(canvas, scale, kGap, kTitleRows + rows * cell_rows + 36);
  return canvas.image();
}

}  // namespace hqslam::tools
