#include "laboratory/compare/confidence_report.h"

#include <fmt/format.h>

#include "report/chart.h"
#include "report/report_style.h"

namespace hqslam::tools {
namespace {

std::string trade_html(const std::vector<OperatingPoint>& points) {
  Chart shares{"confidence below which pixels are emptied", "share", {}, {}};
  Series outliers{"outliers among the points", "upsampling", {}};
  Series missing{"true returns missing", "segmentation", {}};
  Series f1{"F1 of voxels of 0.1 m", "features", {}};
  for (const OperatingPoint& point : points) {
    shares.x.push_back(point.least_confidence);
    outliers.y.push_back(point.outlier_share);
    missing.y.push_back(point.missing_share);
    f1.y.push_back(point.f1);
  }
  shares.series = {outliers, missing, f1};
  return chart_html(shares);
}

std::string reliability_html(const std::vector<ReliabilityBin>& bins) {
  Chart chart{"confidence said", "share that was right", {}, {}};
  Series said{"what would be true", "reading", {}};
  Series found{"what is true", "odometry", {}};
  for (const ReliabilityBin& bin : bins) {
    chart.x.push_back(bin.confidence);
    said.y.push_back(bin.confidence);
    found.y.push_back(bin.right_share);
  }
  chart.series = {said, found};
  return bins.size() < 2 ? "" : chart_html(chart);
}

std::string points_table(const std::vector<OperatingPoint>& points) {
  std::string html =
      "<div class=\"table\"><table><tr><th>confidence</th><th>MAE all, m</th><th>MAE valid, m</th>"
      "<th>outliers</th><th>missing</th><th>F1</th></tr>\n";
  for (const OperatingPoint& p : points) {
    html += fmt::format(
        "<tr><td>{:.2f}</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.2f} %</td><td>{:.2f} %</td>"
        "<td>{:.3f}</td></tr>\n",
        p.least_confidence, p.mae_all_m, p.mae_valid_m, 100.0 * p.outlier_share,
        100.0 * p.missing_share, p.f1);
  }
  return html + "</table></div>\n";
}

}  // namespace

std::string confidence_html(const ConfidenceReport& report) {
  const std::string weights = escape_html(report.weights);
  return page_html(
      "Confidence of " + weights, "",
      fmt::format(
          "<h1>How sure the network is, and how right</h1>\n<p class=\"quiet\">{}, {} scans of "
          "{}</p>\n<h2>Every operating point</h2>\n{}{}<h2>Can it be believed?</h2>\n"
          "<p class=\"quiet\">Computed pixels by tenths of their confidence: how many have their "
          "true return within {:g} m. Mean distance from the diagonal: {:.3f}</p>\n{}",
          weights, report.scans, escape_html(report.recording), trade_html(report.points),
          points_table(report.points), report.tolerance_m, report.calibration_error,
          reliability_html(report.reliability)),
      std::string(kConfidencePageMarker) + "\n");
}

}  // namespace hqslam::tools
