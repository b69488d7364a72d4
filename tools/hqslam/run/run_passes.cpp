#include "run/run_passes.h"

#include <fmt/format.h>

#include <functional>
#include <utility>

#include "recording/capture_check.h"
#include "recording/recording_choice.h"
#include "run/beam_correction.h"
#include "run/slam_session.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

/// SLAM over the recording, with intermediate results now and then, until `is_enough`.
void process_all(ScanSource& source, SlamSession& session, RunOutput& output,
                 const InterruptGuard& interrupt,
                 const std::function<bool(const ReadScan&)>& is_enough) {
  SlamRun& run = session.run();
  run.scans_in_recording = source.size();
  Progress progress(fmt::format("slam {}x{}", run.sensor.rows(), run.sensor.columns),
                    run.wanted.count_of(source.size()));
  read_scans(source, interrupt, run, [&](const ReadScan& read) {
    session.process(read.scan, read.index, read.reading_s);
    if (output.checkpoint_due()) output.write_checkpoint(session.run_so_far());
    progress.update(std::ssize(run.scans), source.read_share());
    return !is_enough(read);
  });
  progress.update(std::ssize(run.scans), source.read_share());
  progress.finish();
  if (run.end == ReadingEnd::kComplete) {
    run.scans_in_recording = std::ssize(run.scans) + run.left_out.scans;
  }
}

/// Determines how points without times were captured, and how many turns of the sensor apart: a
/// wrong assumption costs decimetres. Returns whether it is now stated.
bool determine_capture(RunOptions& options, const SensorModel& sensor) {
  const auto check = check_clouds_without_times(options.input, open_options(options));
  if (!check) return false;
  const bool is_rolling = check->verdict == CaptureTime::kRolling;
  if (check->is_of_kitti) {
    options.capture = "corrected";
    if (is_rolling) {
      to_stderr(
          "hqslam: points have no times: {}; read as corrected, as files of KITTI usually are; "
          "--capture rolling reads them as captured while the sensor turned\n",
          fit_text(*check));
    }
    return true;
  }
  options.capture = is_rolling ? "rolling" : "corrected";
  std::string found = "--capture " + options.capture;
  if (check->turns > 1) {
    options.stamps = stamps_text(check->turns, sensor);
    found += " --stamps " + options.stamps;
  }
  to_stderr("hqslam: points have no times: {}: read as with {}\n", fit_text(*check), found);
  return true;
}

/// What was found on the way, with which the run begins anew.
struct Found {
  std::optional<BeamsOfRun> beams;
  std::optional<pipeline::OwnParts> own_parts;
};

/// Parts of the vehicle that hide so much of the view that SLAM may have gone by them before they
/// were found. Where they hide less, simulated drives are as accurate in one pass.
class LargeOwnParts {
 public:
  /// Whether they have hidden so much for so long that all of them are found.
  bool add(const pipeline::OwnParts& parts) {
    constexpr double kLeastShare = 0.25;
    constexpr int kScans = 50;
    if (parts.share() >= kLeastShare) ++scans_;
    return scans_ == kScans;
  }

 private:
  int scans_ = 0;
};

/// One pass. Nothing where the recording is to be read anew: with the capture of its points, which
/// `options` then has, or with what was `found`.
std::optional<SlamRun> followed(RunOptions& options, RunOutput& output,
                                const InterruptGuard& interrupt, pipeline::UpsampledRecording input,
                                Found& found) {
  ScanSource& source = input.recording;
  const std::size_t printed = source.warnings().size();
  bool may_correct = !options.no_calibration && !found.beams &&
                     !input.upsampler.recorded().measured_rows &&
                     slam_kind(options.slam) == pipeline::SlamKind::kHqslam;
  pipeline::PipelineOptions chosen = pipeline_options(options.slam, options);
  chosen.own_parts = found.own_parts;
  SlamSession session(std::move(input.upsampler), chosen, options.input);
  session.run().located_in = options.map_file;
  session.run().wanted = wanted_scans(options);
  const bool is_first = !found.beams && !found.own_parts;
  if (is_first && determine_capture(options, source.sensor())) return std::nullopt;
  pipeline::BeamCheck check;
  bool begins_anew = false;
  const auto compare_beams = [&] {
    may_correct = false;  // once
    const std::optional<BeamEvidence> evidence = evidence_of(check, session.pipeline());
    if (evidence) found.beams = beams_with_errors(*evidence);
    if (!found.beams) return;
    const std::string complaint = pipeline::complaint_about(found.beams->sensor);
    if (!complaint.empty()) {
      to_stderr("hqslam: {}; the beams are kept\n", complaint);
      found.beams.reset();
      return;
    }
    begins_anew = true;
    options.corrected = found.beams->sensor;
    to_stderr("hqslam: beams: {}; the run begins anew with these\n", beams_text(*found.beams));
  };
  LargeOwnParts large_parts;
  process_all(source, session, output, interrupt, [&](const ReadScan& read) {
    const pipeline::OwnParts& parts = session.pipeline().own_parts();
    if (!found.own_parts && large_parts.add(parts)) {
      begins_anew = true;
      found.own_parts = parts;
      to_stderr(
          "hqslam: parts of the vehicle hide {:.0f} % of the view; the run begins anew "
          "without them\n",
          100.0 * parts.share());
      return true;
    }
    if (may_correct) check.add(read.scan.cloud, session.report(), session.pipeline());
    if (may_correct && check.is_complete()) compare_beams();
    return begins_anew;
  });
  if (may_correct && !begins_anew && !interrupt.stop_requested()) compare_beams();
  if (begins_anew) return std::nullopt;
  print_later_warnings(source, printed);
  session.run().found_beams = found.beams;
  return session.finished(options.save_map);
}

}  // namespace

SlamRun slam_over(RunOptions& options, RunOutput& output, const InterruptGuard& interrupt,
                  pipeline::UpsampledRecording input) {
  Found found;
  std::optional<SlamRun> run = followed(options, output, interrupt, std::move(input), found);
  while (!run) {
    run = followed(options, output, interrupt, upsampled_recording(options, options), found);
  }
  return std::move(*run);
}

}  // namespace hqslam::tools
