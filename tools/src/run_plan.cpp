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
      .add_option("INPUT", choice.input,
                  "Folder of KITTI .bin files, folder of .pcd files, .npy stack of range images "
                  "(N x H x W, float32 metres), or folder written by hqslam simulate")
      ->required()
      ->check(CLI::ExistingPath);
  command.add_option("--sensor", choice.sensor,
                     fmt::format("{}, or a .json file with the beam angles (Ouster's metadata "
                                 "files too); not needed for a simulated drive",
                                 fmt::join(sensor_preset_names(), ", ")));
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
  return open_recording(input, recording_sensor, recording_options);
}

RunPlan plan_of(const RecordingChoice& choice, const nn::SuperResolverOptions& network) {
  RunPlan plan;
  plan.input = choice.input;
  plan.recording_options.row_order =
      choice.row_order == "lowest-first" ? RowOrder::kLowestFirst : RowOrder::kHighestFirst;
  plan.recording_options.capture_time =
      choice.motion_corrected ? CaptureTime::kMotionCorrected : CaptureTime::kRolling;
  if (!choice.upsample.empty()) {
    UpsamplingPlan upsampling = plan_upsampling({choice.input, choice.sensor, choice.upsample,
                                                 choice.rows, choice.least_confidence, network});
    plan.recording_sensor = upsampling.recording_sensor;
    plan.rows = upsampling.rows;
    plan.upsampler = std::move(upsampling.upsampler);
    return plan;
  }
  plan.recording_sensor = required_recording_sensor(choice.input, choice.sensor);
  if (choice.rows > 0 && choice.rows != plan.recording_sensor.rows()) {
    plan.rows = selection_for(plan.recording_sensor.rows(), choice.rows);
  }
  return plan;
}

}  // namespace hqslam::tools
