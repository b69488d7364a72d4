#include "run_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <utility>

#include "recording_sensor.h"
#include "upsampling_plan.h"

namespace hqslam::tools {

void declare_recording(CLI::App& command, RecordingChoice& choice) {
  command
      .add_option(
          "INPUT", choice.input,
          "Capture (.pcap, .pcapng) or bag (.db3, .mcap, .bag) of a sensor, folder of KITTI "
          ".bin files or of .pcd, .ply, .csv or .txt files, .npy stack of range images (N x H x W, "
          "float32 metres), or folder written by hqslam simulate")
      ->required()
      ->check(CLI::ExistingPath);
  command.add_option("--sensor", choice.sensor,
                     fmt::format("{}, or a .json file with the beam angles (Ouster's metadata "
                                 "files too); not needed where the recording says it",
                                 fmt::join(sensor_preset_names(), ", ")));
  command.add_option("--stream", choice.stream,
                     "Which stream of a capture or a bag: a topic, or a port or sender:port");
  command
      .add_option("--return", choice.kept_return,
                  "Which one is kept where a sensor sends two returns of a pulse")
      ->check(CLI::IsMember({"strongest", "last"}))
      ->capture_default_str();
  command
      .add_option("--rows", choice.rows, "Use only this many of the sensor's rows, evenly spread")
      ->check(CLI::Range(1, 1000000000));
  command
      .add_option("--row-order", choice.row_order,
                  "Where row 0 of the images of a .npy stack looks")
      ->check(CLI::IsMember({"highest-first", "lowest-first"}))
      ->capture_default_str();
  command.add_flag("--motion-corrected", choice.motion_corrected,
                   "The scans of a .npy stack are already corrected for the sensor's motion");
  command
      .add_option("--capture", choice.capture,
                  "How points without a time were captured: rolling, while the sensor turned (each "
                  "has the time of its azimuth), or corrected for motion (default)")
      ->check(CLI::IsMember({"rolling", "corrected"}));
  command.add_option("--stamps", choice.stamps,
                     "File with the stamp of each scan (seconds, or dates as KITTI's "
                     "timestamps.txt), or 'names' for the numbers in the files' names");
  command
      .add_option("--upsample", choice.upsample,
                  fmt::format("Fill the rows between the measured ones first: a trained network "
                              "(.npz), or interpolation ({})",
                              fmt::join(nn::interpolation_names(), ", ")))
      ->check(CLI::ExistingFile | CLI::IsMember(nn::interpolation_names()));
  command
      .add_option("--confidence", choice.least_confidence,
                  "With --upsample: leave computed pixels empty of which the network (du-mix) is "
                  "less sure; default: as the weights say")
      ->check(CLI::Range(0.0, 1.0));
}

std::unique_ptr<ScanSource> RunPlan::open() const {
  return open_input(recording, recording_sensor);
}

namespace {

RecordingOptions recording_options(const RecordingChoice& choice) {
  RecordingOptions options;
  options.row_order =
      choice.row_order == "lowest-first" ? RowOrder::kLowestFirst : RowOrder::kHighestFirst;
  options.capture_time =
      choice.motion_corrected ? CaptureTime::kMotionCorrected : CaptureTime::kRolling;
  options.times_from_azimuth = choice.capture == "rolling";
  options.stamps = choice.stamps;
  return options;
}

}  // namespace

RunPlan plan_of(const RecordingChoice& choice, const nn::SuperResolverOptions& network) {
  RunPlan plan;
  plan.recording = {choice.input, choice.sensor, choice.stream, choice.kept_return == "last",
                    recording_options(choice)};
  if (!choice.upsample.empty()) {
    UpsamplingPlan upsampling =
        plan_upsampling({choice.input, choice.sensor, choice.upsample, choice.rows,
                         choice.least_confidence, network, choice.stream});
    plan.recording_sensor = upsampling.recording_sensor;
    plan.rows = upsampling.rows;
    plan.upsampler = std::move(upsampling.upsampler);
    return plan;
  }
  plan.recording_sensor = required_recording_sensor(choice.input, choice.sensor, choice.stream);
  if (choice.rows > 0 && choice.rows != plan.recording_sensor.rows()) {
    plan.rows = selection_for(plan.recording_sensor.rows(), choice.rows);
  }
  return plan;
}

}  // namespace hqslam::tools
