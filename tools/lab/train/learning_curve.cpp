#include "train/learning_curve.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/chart.h"

namespace hqslam::tools {
namespace {

// The drawing area, in the units of the SVG.
constexpr double kLeft = 70.0;
constexpr double kTop = 50.0;
constexpr double kWidth = 700.0;
constexpr double kHeight = 340.0;

double x_of(const PlotBox& box, double x) {
  return kLeft + kWidth * to_plot_x(box, x) / kPlotUnits;
}
double y_of(const PlotBox& box, double y) {
  return kTop + kHeight * to_plot_y(box, y) / kPlotUnits;
}

/// The validation's figures as parts of linear interpolation's.
struct Part {
  const char* colour;
  double (*of)(const nn::Validation& v);
};
constexpr Part kParts[] = {
    {"#d62728", [](const nn::Validation& v) { return v.network.mae_all_m / v.linear.mae_all_m; }},
    {"#1f77b4",
     [](const nn::Validation& v) { return v.network.mae_valid_m / v.linear.mae_valid_m; }},
    {"#2ca02c",
     [](const nn::Validation& v) { return v.network.wrong_share / v.linear.wrong_share; }}};

PlotBox box_of(const std::vector<nn::CurvePoint>& curve) {
  PlotBox box{0.0, static_cast<double>(curve.back().step), 1e9, 0.0};
  for (const nn::CurvePoint& p : curve) {
    for (const auto& part : kParts) {
      const double value = part.of(p.validation);
      box.y_min = std::min(box.y_min, value);
      box.y_max = std::max(box.y_max, value);
    }
  }
  const double margin = 0.05 * std::max(box.y_max - box.y_min, 1e-3);
  box.y_min -= margin;
  box.y_max += margin;
  return box;
}

template <typename Value>
std::string line_svg(const std::vector<nn::CurvePoint>& curve, const PlotBox& box,
                     const char* colour, const Value& value) {
  std::string points;
  for (const nn::CurvePoint& p : curve) {
    points +=
        fmt::format("{:.1f},{:.1f} ", x_of(box, static_cast<double>(p.step)), y_of(box, value(p)));
  }
  return fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"2\" points=\"{}\"/>\n",
                     colour, points);
}

std::string grid_svg(const PlotBox& box) {
  std::string svg;
  for (const double y : ticks_within(box.y_min, box.y_max, tick_step(box.y_max - box.y_min, 5))) {
    svg += fmt::format(
        "<path stroke=\"#ddd\" d=\"M{0} {1:.1f}h{2}\"/><text x=\"{3}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5}</text>\n",
        kLeft, y_of(box, y), kWidth, kLeft - 8.0, y_of(box, y) + 5.0, tick_text(y));
  }
  for (const double x : ticks_within(box.x_min, box.x_max, tick_step(box.x_max - box.x_min, 6))) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                       x_of(box, x), kTop + kHeight + 20.0, tick_text(x));
  }
  return svg;
}

}  // namespace

std::string learning_curve_svg(const std::vector<nn::CurvePoint>& curve) {
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 800 450\" "
      "font-family=\"sans-serif\" font-size=\"14\">\n<rect width=\"800\" height=\"450\" "
      "fill=\"white\"/>\n";
  if (!curve.empty()) {
    const PlotBox box = box_of(curve);
    svg += grid_svg(box);
    for (const Part& part : kParts) {
      svg += line_svg(curve, box, part.colour,
                      [&](const nn::CurvePoint& p) { return part.of(p.validation); });
    }
  }
  svg +=
      "<text x=\"70\" y=\"28\">of linear interpolation's: <tspan fill=\"#d62728\">MAE over all "
      "pixels</tspan>, <tspan fill=\"#1f77b4\">MAE where both have a return</tspan>, <tspan "
      "fill=\"#2ca02c\">wrong points</tspan></text>\n<text x=\"420\" y=\"440\" "
      "text-anchor=\"middle\">step</text>\n</svg>\n";
  return svg;
}

}  // namespace hqslam::tools
