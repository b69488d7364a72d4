#include "live/live_run.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <optional>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/slam/status.h"
#include "run/beam_correction.h"
#include "timing/timing.h"

namespace hqslam::tools {
namespace {

constexpr double kStatusInterval_s = 1.0;
/// How long to wait for a scan before checking for an interruption.
constexpr double kWait_s = 0.1;

/// By the clock that packets are timed with.
std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Finds out beside the drive whether the sensor's beams have errors. They are not corrected on the
/// way, which would bend the map, but from the next drive on.
class LiveBeams {
 public:
  void add(const OrganizedCloud& recorded, SlamSession& session) {
    if (!is_waiting_) return;
    check_.add(recorded, session.report(), session.pipeline());
    if (check_.is_complete()) determine(session);
  }
  /// At the end of the drive. A shorter one is not calibrated now: its results are waited for.
  void finish(SlamSession& session) {
    if (errors_.valid()) session.run().found_beams = errors_.get();
  }

 private:
  void determine(const SlamSession& session) {
    is_waiting_ = false;
    std::optional<BeamEvidence> evidence = evidence_of(check_, session.pipeline());
    if (!evidence) return;
    check_ = pipeline::BeamCheck();
    errors_ = std::async(std::launch::async, [evidence = std::move(*evidence)] {
      omp_set_num_threads(1);  // the other cores are for the poses
      return beams_with_errors(evidence);
    });
  }

  pipeline::BeamCheck check_;
  bool is_waiting_ = true;
  std::future<std::optional<BeamsOfRun>> errors_;
};

/// Follows a run: what its lines and its page are made of.
class LiveProgress {
 public:
  explicit LiveProgress(LiveView* view) : view_(view) {}

  void located(const SlamSession& session, const ScanRecord& record) {
    status_.latest = record;
    status_.latency_s = std::max(status_.latency_s.value_or(0.0), *record.latency_s);
    ++status_.scans;
    ++scans_of_second_;
    if (view_ == nullptr) return;
    if (record.report.loop.correction_m > 0.0) {
      view_->replace(session.pipeline().trajectory(), session.pipeline().segment_of_scan());
    }
    view_->add(session.cloud(), record.report.T_map_sensor,
               session.pipeline().segment_of_scan().back());
  }

  void set_results_failure(const std::string& failure) {
    if (!failure.empty() && status_.results_failure.empty()) {
      to_stderr("hqslam: {}; the drive continues, and it will be tried again\n", failure);
    }
    status_.results_failure = failure;
  }

  void print_if_due(SlamSession& session, const live::LiveCounts& counts) {
    const double passed_s = seconds_since(second_start_);
    if (passed_s < kStatusInterval_s) return;
    status_.elapsed_s = seconds_since(start_);
    status_.rate_hz = static_cast<double>(scans_of_second_) / passed_s;
    status_.counts = counts;
    status_.submaps = session.submaps();
    status_.path_m = known_path_m(session.run_so_far());
    to_stdout("{}\n", status_line(status_));
    if (view_ != nullptr) view_->set(status_);
    second_start_ = SteadyClock::now();
    scans_of_second_ = 0;
    status_.latency_s.reset();
  }

 private:
  LiveView* view_;
  SteadyClock::time_point start_ = SteadyClock::now();
  SteadyClock::time_point second_start_ = start_;
  std::int64_t scans_of_second_ = 0;
  LiveStatus status_;
};

/// The next scan, or nothing within a while or when the port fails, which ends the run.
std::optional<live::LiveScan> next_scan(live::LiveSensor& sensor, SlamRun& run) {
  try {
    return sensor.next(kWait_s);
  } catch (const Error& error) {
    run.end = ReadingEnd::kUnreadableScan;
    run.end_message = error.what();
    return std::nullopt;
  }
}

void process(const live::LiveScan& scan, SlamSession& session, LiveProgress& progress,
             LiveBeams& beams) {
  SlamRun& run = session.run();
  try {
    const std::int64_t index = std::ssize(run.scans) + run.left_out.scans;
    ScanRecord& record = session.process(scan.scan, index, 0.0);
    record.latency_s = 1e-9 * static_cast<double>(now_ns() - scan.completed_ns);
    progress.located(session, record);
    beams.add(scan.scan.cloud, session);
  } catch (const ScanError& error) {
    run.left_out.add(fmt::format("{}: {}", scan.scan.name, error.what()));
  }
}

}  // namespace

std::string failure_of_writing(const std::function<void()>& write) {
  try {
    write();
    return "";
  } catch (const Error& error) {
    return error.what();
  } catch (const std::filesystem::filesystem_error& error) {
    return fmt::format("{}: {}", error.path1().string(), error.code().message());
  }
}

std::string status_line(const LiveStatus& status) {
  std::string line = fmt::format("{:.0f} s  {} scans", status.elapsed_s, status.scans);
  if (status.latest) {
    const Eigen::Vector3d position_m = status.latest->report.T_map_sensor.translation();
    line += fmt::format("  x {:.2f} y {:.2f} z {:.2f} m", position_m.x(), position_m.y(),
                        position_m.z());
    const slam::Status mapping = status.latest->report.mapping_status;
    if (mapping != slam::Status::kOk) line += fmt::format("  mapping {}", slam::name(mapping));
  }
  line += fmt::format("  {:.1f} scans/s", status.rate_hz);
  if (status.latency_s) line += fmt::format("  latency {:.0f} ms", 1e3 * *status.latency_s);
  const live::LiveCounts& counts = status.counts;
  line +=
      fmt::format("  {} packets lost  {} scans dropped", counts.packets.lost, counts.dropped_scans);
  const auto add = [&](std::int64_t count, const char* what) {
    if (count > 0) line += fmt::format("  {} {}", count, what);
  };
  add(counts.lost_scans, "turns lost");
  add(counts.left_out_scans, "scans not decodable");
  add(counts.packets.late, "late or duplicate packets");
  add(counts.packets.foreign, "packets of another kind");
  add(counts.other_senders, "packets of other senders");
  add(counts.senders_changed, "changes of the sensor's address");
  if (status.submaps > 1) line += fmt::format("  {} submaps, not joined", status.submaps);
  if (!counts.trouble.empty()) line += "  " + counts.trouble;
  if (!counts.recording_failure.empty()) line += "  NOT RECORDED ANY MORE";
  if (!status.results_failure.empty()) line += "  RESULTS NOT WRITTEN";
  return line;
}

bool wait_for_sensor(live::LiveSensor& sensor, const InterruptGuard& interrupt) {
  auto last_printed = SteadyClock::now();
  while (!interrupt.stop_requested()) {
    if (sensor.recognize(kWait_s)) return true;
    if (seconds_since(last_printed) < kStatusInterval_s) continue;
    last_printed = SteadyClock::now();
    const std::int64_t seen = sensor.packets_seen();
    if (const std::string complaint = sensor.complaint(); !complaint.empty()) {
      to_stderr("hqslam: {}; waiting for the sensor\n", complaint);
      continue;
    }
    to_stdout("{} on UDP port {}{}\n", seen == 0 ? "no packet yet" : "listening", sensor.port(),
              seen == 0 ? "; does the sensor send to this computer?"
                        : fmt::format(", {} packets, not yet recognized as the sensor's", seen));
  }
  return false;
}

SlamRun run_live(live::LiveSensor& sensor, SlamSession session, RunOutput& output,
                 const InterruptGuard& interrupt, LiveView* view, bool save_map) {
  SlamRun& run = session.run();
  run.command = "live";
  LiveProgress progress(view);
  LiveBeams beams;
  while (!interrupt.stop_requested() && run.end == ReadingEnd::kRunning) {
    if (const std::optional<live::LiveScan> scan = next_scan(sensor, run)) {
      process(*scan, session, progress, beams);
      if (!run.scans.empty() && output.checkpoint_due()) {
        progress.set_results_failure(
            failure_of_writing([&] { output.write_checkpoint(session.run_so_far()); }));
      }
    }
    progress.print_if_due(session, sensor.counts());
  }
  if (run.end == ReadingEnd::kRunning) run.end = ReadingEnd::kComplete;
  const live::LiveCounts counts = sensor.counts();
  run.scans_in_recording = counts.scans;
  run.left_out.scans += counts.left_out_scans;
  if (!counts.first_left_out.empty()) run.left_out.first = counts.first_left_out;
  beams.finish(session);
  return session.finished(save_map);
}

}  // namespace hqslam::tools
