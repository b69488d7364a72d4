#include "inspect_slam/inspect_slam.h"

#include <fmt/format.h>

#include "commands.h"
#include "files/text_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/scan_source.h"
#include "inspect_slam/slam_scan_page.h"
#include "recording/recording_sensor.h"
#include "run/run_plan.h"
#include "run/slam_settings.h"
#include "terminal/exit_status.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

RecordingChoice recording_of(const InspectOptions& options) {
  RecordingChoice choice;
  static_cast<InputChoice&>(choice) = options;
  choice.rows = options.rows;
  choice.upsample = options.weights;
  return choice;
}

SensorModel seen_sensor(const RunPlan& plan) {
  if (plan.upsampler) return plan.upsampler->sensor();
  return plan.rows ? select_rows(plan.recording_sensor, *plan.rows) : plan.recording_sensor;
}

}  // namespace

int inspect_slam(const InspectOptions& options) {
  refuse_to_replace_foreign(options.out, kSlamScanPageMarker);
  require_folder_of(options.out);
  RunPlan plan = plan_of(recording_of(options));
  const SlamRunSpec spec = plan.spec();
  const auto source = plan.open();
  print_warnings(*source, options.input);
  slam::Slam slam(seen_sensor(plan), slam_options(options.slam_settings));
  SlamScanReport page;
  page.recording = options.input;
  page.scan = options.scan;
  LeftOut left_out;
  Progress progress("slam", options.scan + 1);
  for (std::int64_t i = 0; i <= options.scan; ++i) {
    const std::optional<RecordedScan> scan = next_usable(*source, left_out);
    if (!scan) {
      throw Error(fmt::format("{}: has {} scans{}, expected one with index {}", options.input, i,
                              left_out.scans > 0 ? " that can be used" : "", options.scan));
    }
    const OrganizedCloud cloud = prepared_cloud(measured_cloud(scan->cloud, spec), spec);
    page.report = slam.process(cloud, scan->stamp_s, i == options.scan ? &page.trace : nullptr);
    progress.update(i + 1);
  }
  progress.finish();
  write_text_file(slam_scan_html(page), options.out);
  to_stdout("results: {}\n", options.out);
  return kOk;
}

}  // namespace hqslam::tools
