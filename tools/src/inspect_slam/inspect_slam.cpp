#include "inspect_slam/inspect_slam.h"

#include <fmt/format.h>

#include "commands.h"
#include "files/output_guard.h"
#include "files/text_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/scan_source.h"
#include "inspect_slam/slam_scan_page.h"
#include "lift/lifted_input.h"
#include "recording/reading.h"
#include "recording/recording_sensor.h"
#include "run/slam_settings.h"
#include "terminal/exit_status.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

int inspect_slam(const InspectOptions& options) {
  guard_output_file(options.out, {options.input, options.weights},
                    [](const auto& path) { return has_marker(path, kSlamScanPageMarker); });
  LiftingChoice lifting;
  lifting.rows = options.rows;
  lifting.upsample = options.weights;
  LiftedInput input = lifted_input(options, lifting);
  const auto source = input.open();
  print_warnings(*source, options.input);
  slam::Slam slam(input.seen(), slam_options(options.slam_settings));
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
    const OrganizedCloud cloud = input.lifted(input.measured(scan->cloud));
    page.report = slam.process(cloud, scan->stamp_s, i == options.scan ? &page.trace : nullptr);
    progress.update(i + 1);
  }
  progress.finish();
  write_text_file(slam_scan_html(page), options.out);
  to_stdout("results: {}\n", options.out);
  return kOk;
}

}  // namespace hqslam::tools
