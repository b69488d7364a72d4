#include "run/run_plan.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "lift/upsampling_plan.h"

namespace hqslam::tools {

namespace {

/// What is to be made of scans of a sensor that the request or its recording names.
RunPlan planned(UpsamplingRequest request, const LiftingChoice& choice) {
  RunPlan plan;
  if (choice.upsample.empty()) {
    plan.recording_sensor =
        request.sender ? *request.sender
                       : required_recording_sensor(request.input, request.sensor, request.stream);
    const int rows = plan.recording_sensor.rows();
    if (choice.rows > 0 && choice.rows != rows) plan.rows = selection_for(rows, choice.rows);
    return plan;
  }
  request.method = choice.upsample;
  request.rows = choice.rows;
  request.confidence = choice;
  UpsamplingPlan upsampling = plan_upsampling(request);
  plan.recording_sensor = upsampling.recording_sensor;
  plan.rows = upsampling.rows;
  plan.upsampler = std::move(upsampling.upsampler);
  return plan;
}

}  // namespace

void declare_recording(CLI::App& command, RecordingChoice& choice) {
  declare_input(command, choice);
  declare_lifting(command, choice);
}

std::unique_ptr<ScanSource> RunPlan::open() {
  if (opened) return std::move(opened);
  return open_input(recording, recording_sensor);
}

RunPlan plan_of(const RecordingChoice& choice, const nn::SuperResolverOptions& network) {
  UpsamplingRequest request;
  request.input = choice.input;
  request.sensor = choice.sensor;
  request.stream = choice.stream;
  request.network_options = network;
  auto stream = open_stream(choice);
  if (stream) request.sender = stream->sensor();
  RunPlan plan = planned(std::move(request), choice);
  plan.recording = choice;
  if (stream) {
    stream->use_columns(plan.recording_sensor.columns);
    plan.opened = std::move(stream);
  }
  return plan;
}

RunPlan plan_of(const LiftingChoice& choice, const SensorModel& sensor, const std::string& name,
                bool knows_beams) {
  UpsamplingRequest request;
  request.input = name;
  request.sender = sensor;
  request.knows_sender_beams = knows_beams;
  RunPlan plan = planned(std::move(request), choice);
  plan.recording.input = name;
  return plan;
}

}  // namespace hqslam::tools
