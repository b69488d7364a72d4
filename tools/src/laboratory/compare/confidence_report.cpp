#include "laboratory/compare/confidence_report.h"

#include <fmt/format.h>

#include "report/chart.h"
#include "report/page.h"

namespace hqslam::tools {
namespace {

/// A point per row: of what `x` says the figures that `series` says.
template <typename Row>
struct Line {
  const char* name;
  const char* css_class;
  double Row::*y;
};
template <typename Row>
std::string lines_html(const std::vector<Row>& rows, double Row::*x, const char* x_label,
                       const char* y_label, const std::vector<Line<Row>>& lines) {
  Chart chart{x_label, y_label, {}, {}};
  for (const Row& row : rows) chart.x.push_back(row.*x);
  for (const Line<Row>& line : lines) {
    Series& series = chart.series.emplace_back(Series{line.name, line.css_class, {}});
    for (const Row& row : rows) series.y.push_back(row.*line.y);
  }
  return chart_html(chart);
}

}  // namespace

const std::vector<Figure<OperatingPoint>>& operating_figures() {
  using P = OperatingPoint;
  static const std::vector<Figure<P>> figures = {
      {"MAE all m", "mae_all_m", 3, 1.0, [](const P& p) { return p.mae_all_m; }},
      {"MAE valid m", "mae_valid_m", 3, 1.0, [](const P& p) { return p.mae_valid_m; }},
      {"outliers %", "outlier_share", 2, 100.0, [](const P& p) { return p.outlier_share; }},
      {"missing %", "missing_share", 2, 100.0, [](const P& p) { return p.missing_share; }},
      {"F1", "f1", 3, 1.0, [](const P& p) { return p.f1; }}};
  return figures;
}

TextTable operating_table(const std::vector<OperatingPoint>& points) {
  return table_of(points, "confidence", operating_figures(), [](const OperatingPoint& point) {
    return figure_text(point.least_confidence, 2);
  });
}

std::string confidence_html(const ConfidenceReport& report) {
  Page page("Confidence of " + report.weights);
  page.head_html(kConfidencePageMarker);
  page.heading(1, "How sure the network is, and how right");
  page.paragraph(fmt::format("{}, {} scans of {}", report.weights, report.scans, report.recording));
  page.heading(2, "Every operating point");
  page.html(lines_html<OperatingPoint>(
      report.points, &OperatingPoint::least_confidence, "confidence below which pixels are emptied",
      "share",
      {{"outliers among the points", "upsampling", &OperatingPoint::outlier_share},
       {"true returns missing", "segmentation", &OperatingPoint::missing_share},
       {"F1 of voxels of 0.1 m", "features", &OperatingPoint::f1}}));
  page.table(operating_table(report.points));
  page.heading(2, "Can it be believed?");
  page.paragraph(fmt::format(
      "Computed pixels by tenths of their confidence: how many have their true return within {:g} "
      "m. Mean distance from the diagonal: {:.3f}",
      report.tolerance_m, report.calibration_error));
  if (report.reliability.size() > 1) {
    page.html(lines_html<ReliabilityBin>(
        report.reliability, &ReliabilityBin::confidence, "confidence said", "share that was right",
        {{"what would be true", "reading", &ReliabilityBin::confidence},
         {"what is true", "odometry", &ReliabilityBin::right_share}}));
  }
  return page.text();
}

}  // namespace hqslam::tools
