#include "report/chart.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "hqslam/core/excerpt.h"
#include "hqslam/evaluation/png.h"

namespace hqslam::tools {
namespace {

/// "M0,500.2L3.1,480..." through the points of a line; a point alone between gaps is a dot.
std::string path_through(const PlotBox& box, const std::vector<double>& x,
                         const std::vector<double>& y) {
  const auto is_gap = [&](std::size_t i) { return i >= y.size() || std::isnan(y[i]); };
  std::string path;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (is_gap(i)) continue;
    const bool begins = is_gap(i - 1);  // of the first, too: unsigned numbers wrap around
    path += fmt::format("{}{:.1f},{:.1f}{}", begins ? 'M' : 'L', to_plot_x(box, x[i]),
                        to_plot_y(box, y[i]), begins && is_gap(i + 1) ? "h0" : "");
  }
  return path;
}

/// The values of each layer with all layers below it added.
std::vector<std::vector<double>> heights_of(const Chart& chart) {
  std::vector<std::vector<double>> heights;
  for (const Series& series : chart.series) {
    heights.push_back(series.y);
    if (chart.stacked && heights.size() > 1) {
      const std::vector<double>& below = heights[heights.size() - 2];
      std::ranges::transform(below, series.y, heights.back().begin(), std::plus());
    }
  }
  return heights;
}

PlotBox box_of(const Chart& chart, const std::vector<std::vector<double>>& heights) {
  PlotBox box;
  double highest = 0.0;
  double lowest = 0.0;
  for (const std::vector<double>& line : heights) {
    for (const double value : line) {
      highest = std::max(highest, value);
      lowest = std::min(lowest, value);
    }
  }
  const auto [x_min, x_max] = std::ranges::minmax_element(chart.x);  // clocks may fall
  box.x_min = *x_min;
  box.x_max = *x_max > *x_min ? *x_max : *x_min + 1.0;
  box.y_min = 1.08 * lowest;
  box.y_max = highest > lowest ? 1.08 * highest : 1.0;
  return box;
}

/// Lines, or layers from the highest to the lowest, each down to 0 and drawn over by the next.
std::string series_svg(const Chart& chart, const PlotBox& box,
                       const std::vector<std::vector<double>>& heights) {
  std::string svg;
  for (std::size_t i = heights.size(); i-- > 0;) {
    const std::string path = path_through(box, chart.x, heights[i]);
    if (chart.stacked) {
      svg +=
          fmt::format("<path class=\"layer {}\" d=\"{}V{}H{:.1f}Z\"/>\n", chart.series[i].css_class,
                      path, kPlotUnits, to_plot_x(box, chart.x.front()));
    } else {
      svg += fmt::format("<path class=\"line {}\" d=\"{}\"/>\n", chart.series[i].css_class, path);
    }
  }
  return svg;
}

std::string legend_html(const Chart& chart) {
  if (chart.series.size() < 2) return "";
  std::string html = "<ul class=\"legend\">";
  for (const Series& series : chart.series) {
    html +=
        fmt::format("<li><i class=\"{}\"></i>{}</li>", series.css_class, escape_html(series.name));
  }
  return html + "</ul>\n";
}

}  // namespace

std::string escape_html(std::string_view text) {
  constexpr std::string_view kSpecial = "&<>\"";
  constexpr std::array<std::string_view, 4> kEntities = {"&amp;", "&lt;", "&gt;", "&quot;"};
  std::string escaped;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_bytes(text.substr(i));
    if (length == 0) {
      escaped += "\xEF\xBF\xBD";
    } else if (const std::size_t special = kSpecial.find(text[i]); special < kSpecial.size()) {
      escaped += kEntities[special];
    } else {
      escaped += text.substr(i, length);
    }
    i += std::max<std::size_t>(length, 1);
  }
  return escaped;
}

double tick_step(double extent, int wanted) {
  const double rough = extent / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double mantissa = rough / power;
  return power * (mantissa < 1.5 ? 1.0 : mantissa < 3.5 ? 2.0 : mantissa < 7.5 ? 5.0 : 10.0);
}

std::vector<double> ticks_within(double min, double max, double step) {
  std::vector<double> ticks;
  const auto last = static_cast<std::int64_t>(std::floor(max / step + 1e-9));
  for (auto i = static_cast<std::int64_t>(std::ceil(min / step - 1e-9)); i <= last; ++i) {
    ticks.push_back(static_cast<double>(i) * step);
  }
  return ticks;
}

std::string tick_text(double value) { return fmt::format("{:.6g}", value); }

double to_plot_x(const PlotBox& box, double x) {
  return kPlotUnits * (x - box.x_min) / (box.x_max - box.x_min);
}

double to_plot_y(const PlotBox& box, double y) {
  return kPlotUnits * (box.y_max - y) / (box.y_max - box.y_min);
}

PlotGrid plot_grid(const PlotBox& box, const std::vector<double>& x_ticks,
                   const std::vector<double>& y_ticks) {
  PlotGrid grid;
  std::string path;
  for (const double tick : x_ticks) {
    const double x = to_plot_x(box, tick);
    path += fmt::format("M{:.1f},0V{}", x, kPlotUnits);
    grid.labels_html += fmt::format("<span class=\"x tick\" style=\"left:{:.2f}%\">{}</span>",
                                    100.0 * x / kPlotUnits, tick_text(tick));
  }
  for (const double tick : y_ticks) {
    const double y = to_plot_y(box, tick);
    path += fmt::format("M0,{:.1f}H{}", y, kPlotUnits);
    grid.labels_html += fmt::format("<span class=\"y tick\" style=\"top:{:.2f}%\">{}</span>",
                                    100.0 * y / kPlotUnits, tick_text(tick));
  }
  grid.svg = fmt::format("<path class=\"grid\" d=\"{}\"/>\n", path);
  return grid;
}

std::string chart_html(const Chart& chart) {
  const std::vector<std::vector<double>> heights = heights_of(chart);
  const PlotBox box = box_of(chart, heights);
  const PlotGrid grid =
      plot_grid(box, ticks_within(box.x_min, box.x_max, tick_step(box.x_max - box.x_min, 6)),
                ticks_within(box.y_min, box.y_max, tick_step(box.y_max - box.y_min, 4)));
  return fmt::format(
      "{}<p class=\"axis\">{}</p>\n<div class=\"plot chart\">"
      "<svg viewBox=\"0 0 1000 1000\" preserveAspectRatio=\"none\" role=\"img\" "
      "aria-label=\"{} over {}\">\n{}{}</svg>{}</div>\n<p class=\"axis below\">{}</p>\n",
      legend_html(chart), escape_html(chart.y_label), escape_html(chart.y_label),
      escape_html(chart.x_label), series_svg(chart, box, heights), grid.svg, grid.labels_html,
      escape_html(chart.x_label));
}

int error_color_class(double share) {
  return static_cast<int>(std::min(std::clamp(share, 0.0, 1.0) * kErrorColors, kErrorColors - 1.0));
}

std::string error_color(double share) {
  constexpr std::array<Rgb, 4> kStops = {
      {{44, 92, 212}, {146, 66, 196}, {222, 60, 116}, {250, 150, 40}}};
  return fmt::format("#{:02x}", fmt::join(color_between(kStops, share), ""));
}

std::string error_color_of_class(int color_class) {
  return error_color((color_class + 0.5) / kErrorColors);
}

std::string error_gradient() {
  constexpr int kSteps = 6;
  std::string gradient = error_color(0.0);
  for (int i = 1; i <= kSteps; ++i) gradient += ", " + error_color(1.0 * i / kSteps);
  return gradient;
}

}  // namespace hqslam::tools
