#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hqslam::tools {

/// Text with the characters escaped that HTML would take for markup. Bytes that are not UTF-8 come
/// out as U+FFFD.
std::string escape_html(std::string_view text);

/// A step of 1, 2 or 5 times a power of ten that divides `extent` into about `wanted` parts.
double tick_step(double extent, int wanted);
/// The multiples of `step` within [min, max].
std::vector<double> ticks_within(double min, double max, double step);
/// A tick without needless digits: 0.05, 20.
std::string tick_text(double value);

/// What a plot shows, in the units of its axes.
struct PlotBox {
  double x_min = 0.0;
  double x_max = 1.0;
  double y_min = 0.0;
  double y_max = 1.0;
};

/// A plot's drawing area is 1000 x 1000 units, stretched to the size of its box: lines keep their
/// width (non-scaling strokes) and all text stands outside, in HTML, so that it is as large on a
/// phone as on a desktop.
inline constexpr double kPlotUnits = 1000.0;
double to_plot_x(const PlotBox& box, double x);  ///< rightwards
double to_plot_y(const PlotBox& box, double y);  ///< downwards, as SVG has it

/// Grid lines as SVG and their labels as HTML.
struct PlotGrid {
  std::string svg;
  std::string labels_html;
};
PlotGrid plot_grid(const PlotBox& box, const std::vector<double>& x_ticks,
                   const std::vector<double>& y_ticks);

/// One line or one layer of a chart.
struct Series {
  std::string name;
  std::string css_class;  ///< of the page's style: its colour
  std::vector<double> y;  ///< one value per x of the chart; not a number: a gap in the line
};

struct Chart {
  std::string x_label;
  std::string y_label;
  std::vector<double> x;  ///< rising
  std::vector<Series> series;
  bool stacked = false;  ///< layers on top of one another instead of lines
};

/// A chart with its legend, as HTML with inline SVG.
std::string chart_html(const Chart& chart);

/// Colours of errors on all pages, as so many classes: paths with the same one are drawn as one.
inline constexpr int kErrorColors = 20;
/// The class of an error, `share` 0 (none) to 1 (the largest).
int error_color_class(double share);
/// "#rrggbb" of an error: blue, violet, pink, orange, told apart on white and on black, and by the
/// colour-blind by lightness.
std::string error_color(double share);
/// The same for all errors of a class.
std::string error_color_of_class(int color_class);
/// "#2c5cd4, ..., #fa9628": the colours from none to the largest, for a CSS gradient.
std::string error_gradient();

}  // namespace hqslam::tools
