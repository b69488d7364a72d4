#include "run/run_plan.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "lift/upsampling_plan.h"

namespace hqslam::tools {

namespace {

/// What is to be made of scans of a sensor that request.sensor or its recording name.
RunPlan lifted(UpsamplingRequest request, const LiftingChoice& choice) {
  request.method = choice.upsample;
  request.rows = choice.rows;
  request.confidence = choice;
  UpsamplingPlan upsampling = plan_upsampling(request);
  RunPlan plan;
  plan.recording_sensor = upsampling.recording_sensor;
  plan.rows = upsampling.rows;
  plan.upsampler = std::move(upsampling.upsampler);
  return plan;
}

RunPlan not_lifted(const SensorModel& sensor, const LiftingChoice& choice) {
  RunPlan plan;
  plan.recording_sensor = sensor;
  if (choice.rows > 0 && choice.rows != sensor.rows()) {
    plan.rows = selection_for(sensor.rows(), choice.rows);
  }
  return plan;
}

}  // namespace

void declare_recording(CLI::App& command, RecordingChoice& choice) {
  declare_input(command, choice);
  declare_lifting(command, choice);
}

std::unique_ptr<ScanSource> RunPlan::open() const {
  return open_input(recording, recording_sensor);
}

RunPlan plan_of(const RecordingChoice& choice, const nn::SuperResolverOptions& network) {
  RunPlan plan;
  if (choice.upsample.empty()) {
    plan =
        not_lifted(required_recording_sensor(choice.input, choice.sensor, choice.stream), choice);
  } else {
    UpsamplingRequest request;
    request.input = choice.input;
    request.sensor = choice.sensor;
    request.stream = choice.stream;
    request.network_options = network;
    plan = lifted(request, choice);
  }
  plan.recording = input_recording(choice);
  return plan;
}

RunPlan plan_of(const LiftingChoice& choice, const SensorModel& sensor, const std::string& name) {
  RunPlan plan;
  if (choice.upsample.empty()) {
    plan = not_lifted(sensor, choice);
  } else {
    UpsamplingRequest request;
    request.input = name;
    request.sender = sensor;
    plan = lifted(request, choice);
  }
  plan.recording.input = name;
  return plan;
}

}  // namespace hqslam::tools
