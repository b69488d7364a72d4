#include "report/chart.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tools/parts_of_text.h"

namespace hqslam::tools {

TEST_CASE("ticks stand at 1, 2 or 5 times a power of ten, whatever the extent") {
  for (const double extent : {1e-4, 0.03, 0.7, 1.0, 9.0, 71.2, 4000.0, 1.3e6}) {
    CAPTURE(extent);
    const double step = tick_step(extent, 5);
    const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
    const bool round = std::abs(mantissa - 1.0) < 1e-6 || std::abs(mantissa - 2.0) < 1e-6 ||
                       std::abs(mantissa - 5.0) < 1e-6;
    CHECK(round);
    CHECK(extent / step >= 2.5);
    CHECK(extent / step <= 10.0);
  }
}

TEST_CASE("ticks lie within the bounds, both ends included") {
  CHECK(ticks_within(-10.0, 20.0, 10.0) == std::vector<double>{-10.0, 0.0, 10.0, 20.0});
  CHECK(ticks_within(0.1, 0.9, 1.0).empty());
  CHECK(tick_text(3 * 0.1) == "0.3");
  CHECK(tick_text(-20.0) == "-20");
}

TEST_CASE("markup in a file name is shown, not obeyed") {
  CHECK(escape_html("<b>&\"x\"") == "&lt;b&gt;&amp;&quot;x&quot;");
  CHECK(escape_html("Stra\xC3\x9F"
                    "e") ==
        "Stra\xC3\x9F"
        "e");
}

TEST_CASE("bytes that are not UTF-8 become replacement characters") {
  CHECK(escape_html("a\xFF"
                    "b") ==
        "a\xEF\xBF\xBD"
        "b");
  CHECK(escape_html("a\xC3") == "a\xEF\xBF\xBD");  // truncated
  CHECK(escape_html("\xE2\x28\xA1") == "\xEF\xBF\xBD(\xEF\xBF\xBD");
}

TEST_CASE("x runs to the right and y upwards over the whole plot") {
  const PlotBox box{-1.0, 3.0, 10.0, 20.0};
  CHECK(to_plot_x(box, -1.0) == 0.0);
  CHECK(to_plot_x(box, 3.0) == kPlotUnits);
  CHECK(to_plot_y(box, 20.0) == 0.0);
  CHECK(to_plot_y(box, 10.0) == kPlotUnits);
}

TEST_CASE("a line below zero stays within the plot, and zero is where it crosses") {
  const Chart chart{"beam", "mm", {0.0, 1.0}, {{"off", "a", {-5.0, 5.0}}}};
  // From -5.4 to 5.4: y = 500 (1 - value / 5.4).
  const std::string html = chart_html(chart);
  CHECK(holds(html, "M0.0,963.0L1000.0,37.0"));
}

TEST_CASE("a value that is not there is a gap in its line, and one alone is a dot") {
  const double none = std::nan("");
  const Chart chart{"beam", "mm", {0.0, 1.0, 2.0, 3.0}, {{"off", "a", {5.0, none, 5.0, 0.0}}}};
  CHECK(holds(chart_html(chart), "d=\"M0.0,74.1h0M666.7,74.1L1000.0,1000.0\""));
}

TEST_CASE("stacked layers stand on one another: the upper one's outline is the sum") {
  const Chart chart{
      "scan", "ms", {0.0, 1.0}, {{"low", "a", {1.0, 1.0}}, {"high", "b", {3.0, 1.0}}}, true};
  // The highest sum is 4 and stands at 1/1.08 of the height: y = 1000 (1 - 4 / 4.32) = 74.1.
  const std::string html = chart_html(chart);
  CHECK(holds(html, "class=\"layer b\" d=\"M0.0,74.1L1000.0,537.0V"));
  CHECK(holds(html, "class=\"layer a\" d=\"M0.0,768.5L1000.0,768.5V"));
  CHECK(html.find("layer b") < html.find("layer a"));
}

TEST_CASE("a chart over a clock that is set back goes from its least to its greatest time") {
  const Chart chart{"time", "m", {1.0, 3.0, 1.0}, {{"error", "a", {0.0, 0.0, 0.0}}}, false};
  const std::string html = chart_html(chart);
  CHECK(holds(html, "d=\"M0.0,1000.0L1000.0,1000.0L0.0,1000.0"));
}

TEST_CASE("a chart of one point or of zeros has no infinite number in it") {
  Chart chart;
  chart.x = {5.0};
  chart.series = {{"error", "error", {0.0}}};
  const std::string html = chart_html(chart);
  CHECK_FALSE(holds(html, "nan"));
  CHECK_FALSE(holds(html, "inf"));
}

TEST_CASE("the largest error has the last colour of the scale and no error the first") {
  CHECK(error_color(0.0) == "#2c5cd4");
  CHECK(error_color(1.0) == "#fa9628");
  CHECK(error_color(7.0) == error_color(1.0));
  CHECK(error_color(1.0 / 3.0) == "#9242c4");
}

TEST_CASE("errors fall into as many classes as there are colours, the largest into the last") {
  CHECK(error_color_class(0.0) == 0);
  CHECK(error_color_class(-1.0) == 0);
  CHECK(error_color_class(0.51) == kErrorColors / 2);
  CHECK(error_color_class(1.0) == kErrorColors - 1);
  CHECK(error_color_class(7.0) == kErrorColors - 1);
  CHECK(error_color_of_class(0) == error_color(0.5 / kErrorColors));
}

TEST_CASE("the gradient goes from the first colour to the last") {
  CHECK(error_gradient().rfind("#2c5cd4, ", 0) == 0);
  CHECK(error_gradient().substr(error_gradient().size() - 9) == ", #fa9628");
}

}  // namespace hqslam::tools
