#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "files/result_files.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/pipeline/beam_check.h"
#include "hqslam/pipeline/pipeline.h"
#include "hqslam/recordings/recording.h"
#include "product.h"
#include "program/invocation.h"
#include "recording/capture_check.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "run/beam_correction.h"
#include "run/run_summary.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct InfoOptions {
  std::string input;
  std::string sensor;  ///< empty: the recording's own
  std::string stream;  ///< empty: the only one with scans
  std::string write_sensor;
};

namespace fs = std::filesystem;

void print_line(const char* what, const std::string& text) { to_stdout("{:<12}{}\n", what, text); }

std::string sensor_line(const recordings::RecordingInfo& info) {
  const SensorModel& sensor = info.sensor;
  return fmt::format("{}{}: {} rows x {} columns, {:.4g} turns a second", sensor.name,
                     info.sensor_known ? "" : " (as stated)", sensor.rows(), sensor.columns,
                     1.0 / sensor.scan_period_s);
}

std::string beams_line(const SensorModel& sensor) {
  std::vector<std::string> angles_deg;
  for (const double angle_rad : sensor.beam_elevation_rad) {
    angles_deg.push_back(fmt::format("{:.4g}", degrees(angle_rad)));
  }
  return fmt::format("{} degrees", fmt::join(angles_deg, " "));
}

std::string scans_line(const recordings::RecordingInfo& info) {
  std::string text = fmt::format("{} in {:.2f} s", info.scans, info.duration_s);
  if (info.partial_scans > 0) {
    text += fmt::format(" (and {} incomplete at the ends)", info.partial_scans);
  }
  return text;
}

std::string packets_line(const recordings::RecordingInfo& info) {
  const recordings::PacketCounts& packets = info.packets;
  return fmt::format("{} used, {} lost{}, {} late or doubled, {} of another kind", packets.used,
                     packets.lost,
                     info.lost_scans > 0 ? fmt::format(" and {} whole turns", info.lost_scans) : "",
                     packets.late, packets.foreign);
}

/// complaint: pipeline::Pipeline::imu_complaint()
std::string imu_line(const recordings::RecordingInfo& info, const std::string& complaint) {
  if (info.imu_stream.empty() && info.imu.used == 0) return "none in the recording";
  return fmt::format("{}{} samples, {:.4g} a second{}",
                     info.imu_stream.empty() ? "" : info.imu_stream + ", ", info.imu.used,
                     info.imu_rate_hz, complaint.empty() ? "" : "; not used: " + complaint);
}

std::string what_is_in(const recordings::Stream& stream) {
  if (!stream.type.empty()) return "of " + stream.type;
  if (stream.kind == recordings::StreamKind::kInertialData) return "packets of inertial data";
  return stream.kind == recordings::StreamKind::kVelodynePositions
             ? "packets of positions, no scans"
             : "packets";
}

/// What SLAM along the first scans shows.
struct FirstScans {
  std::string own_parts;            ///< pipeline::OwnParts::text()
  std::optional<BeamsOfRun> beams;  ///< that have errors
  std::string ground;               ///< complaint_about_ground()
  std::string imu;                  ///< pipeline::Pipeline::imu_complaint()
};

FirstScans followed(const InfoOptions& options, const recordings::RecordingInfo& info,
                    std::optional<CaptureTime> captured) {
  constexpr std::int64_t kScans = 150;
  recordings::OpenOptions open;
  open.sensor = options.sensor;
  open.stream = info.stream;
  if (open.sensor.empty()) open.all_rows = info.sensor;
  open.files.capture = captured;
  auto source = recordings::Recording::open(options.input, open);
  pipeline::PipelineOptions without_loops;
  without_loops.slam_options.loop_closing.enabled = false;
  pipeline::Pipeline pipeline(source.sensor(), without_loops);
  pipeline::BeamCheck beams;
  LeftOut left_out;
  std::vector<double> shares_on_ground;
  Progress progress("followed", std::min(kScans, info.scans));
  try {
    for (std::int64_t i = 0; i < kScans; ++i) {
      auto scan = next_usable(source, left_out);
      if (!scan) break;
      const slam::ScanReport report = pipeline.process(*scan).report;
      if (report.returns > 0) shares_on_ground.push_back(share_on_ground(report));
      beams.add(scan->cloud, report, pipeline);
      progress.update(i + 1);
    }
  } catch (const Error&) {
    // The recording is cut off, of which its description warns.
  }
  progress.finish();
  FirstScans result{pipeline.own_parts().text(), std::nullopt,
                    complaint_about_ground(shares_on_ground), pipeline.imu_complaint()};
  if (const auto evidence = evidence_of(beams, pipeline)) {
    result.beams = beams_with_errors(*evidence);
  }
  return result;
}

/// Where the points are not what they are taken for.
std::string capture_options(const CaptureCheck& check, const SensorModel& sensor, bool is_stack,
                            bool has_times) {
  const bool is_corrected = check.verdict == CaptureTime::kMotionCorrected;
  if (is_corrected && (is_stack || has_times)) return " --capture corrected";
  std::string options;
  if (check.verdict == CaptureTime::kRolling && !is_stack && !has_times) {
    options = " --capture rolling";
  }
  if (check.turns > 1) options += " --stamps " + stamps_text(check.turns, sensor);
  return options;
}

std::string command_for(const InfoOptions& options, const std::string& capture) {
  std::string command = fmt::format("hqslam run {}", shell_word(options.input));
  if (!options.sensor.empty()) command += fmt::format(" --sensor {}", shell_word(options.sensor));
  if (!options.stream.empty()) command += fmt::format(" --stream {}", shell_word(options.stream));
  return command + capture + " --out results";
}

void declare(CLI::App& app, InfoOptions& options) {
  add_command(app, "info", "Describe a recording, and print the command to run on it",
              "Reads captures and bags to their end, of other recordings the first 100 scans, and\n"
              "follows the first 150 by SLAM, for parts of the vehicle and errors of beams.")
      .option("INPUT", &options.input, "Recording (as for hqslam run)",
              {.required = true, .given = Given::kFileOrFolder})
      .option(
          "--sensor", &options.sensor,
          fmt::format(
              "Sensor: {}, or a .json file; default: determined from the recording or its points",
              fmt::join(sensor_preset_names(), ", ")))
      .option("--stream", &options.stream,
              "Stream, if there are several: a topic of a bag, or a port or sender:port of a "
              "capture")
      .option("--write-sensor", &options.write_sensor,
              "Sensor file (.json) to write, for --sensor of every other command");
}

int run(const InfoOptions& options) {
  if (!options.write_sensor.empty()) {
    guard_output_file(options.write_sensor, {options.input, options.sensor},
                      [](const std::string&) { return false; });  // users change them
  }
  recordings::OpenOptions open;
  open.sensor = options.sensor;
  open.stream = options.stream;
  const bool is_stack = fs::path(options.input).extension() == ".npy";
  recordings::RecordingInfo info = recordings::inspect(options.input, open);
  print_line("file", fmt::format("{}: {}", options.input, info.kind));
  for (const recordings::Stream& stream : info.streams) {
    print_line(stream.name == info.stream ? "stream" : "  also",
               fmt::format("{}, {} {}", stream.name, stream.messages, what_is_in(stream)));
  }
  std::string complaint;  // the last warning, where no scan is the sensor's
  if (info.format.empty() && !info.warnings.empty()) {
    complaint = std::move(info.warnings.back());
    info.warnings.pop_back();
  }
  print_line("holds", complaint.empty() ? info.format : "no scan that can be read so");
  print_line("sensor", sensor_line(info));
  print_line("beams", beams_line(info.sensor));
  print_line("scans", scans_line(info));
  print_line("stamps", info.has_stamps
                           ? fmt::format("from the recording, first {:.6f} s", info.first_stamp_s)
                           : "none: counted in turns of the sensor from 0 s");
  print_line("points", info.has_point_times ? "each with its own time: corrected for motion by SLAM"
                                            : "without times: taken as corrected for motion");
  std::string capture;
  std::optional<CaptureTime> captured;
  const bool has_clouds = info.streams.empty() ? file_of_drive(options.input, "scans.npy").empty()
                                               : info.format.starts_with("point clouds");
  // A folder's sensor.json may state it.
  if (complaint.empty() && !info.sensor.motion_corrected && (is_stack || has_clouds)) {
    const CaptureCheck check = check_capture(options.input, info.sensor,
                                             {.sensor = options.sensor, .stream = info.stream});
    print_line("captured", fit_text(check));
    captured = check.verdict;
    capture = capture_options(check, info.sensor, is_stack, info.has_point_times);
  }
  std::string imu_complaint;
  if (complaint.empty()) {
    const FirstScans scans = followed(options, info, captured);
    if (!scans.own_parts.empty()) {
      print_line("vehicle", scans.own_parts + ": its own parts, which SLAM leaves out");
    }
    if (!scans.ground.empty()) print_line("ground", scans.ground);
    if (scans.beams) print_line("errors", beams_text(*scans.beams) + "; hqslam run corrects them");
    imu_complaint = scans.imu;
  }
  if (!info.streams.empty() || info.imu.used > 0) {
    print_line("inertial", imu_line(info, imu_complaint));
  }
  if (info.packets.used > 0) print_line("packets", packets_line(info));
  for (const std::string& warning : info.warnings) print_line("note", warning);
  if (!complaint.empty()) throw Error(complaint);
  if (!options.write_sensor.empty()) {
    write_sensor_json(info.sensor, options.write_sensor);
    print_line("written", options.write_sensor);
  }
  print_line("run", command_for(options, capture));
  return kOk;
}

}  // namespace

void add_info(CLI::App& app, Chosen& chosen) { add_subcommand<InfoOptions>(app, chosen); }

}  // namespace hqslam::tools
