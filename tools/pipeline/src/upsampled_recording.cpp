#include "hqslam/pipeline/upsampled_recording.h"

#include <optional>
#include <utility>

namespace hqslam::pipeline {

using recordings::Recording;

UpsampledRecording open_upsampled(const std::string& path, recordings::OpenOptions options,
                                  UpsamplingOptions upsampling) {
  std::optional<SensorModel> recorded;
  if (is_weights_name(upsampling.method)) recorded = Recording::open(path, options).sensor();
  UpsamplingMethod method = load_method(upsampling, recorded);
  const bool is_stream = recordings::is_capture_or_bag(path);
  if (std::holds_alternative<nn::SuperResolver>(method)) {
    options.all_rows = sensor_of(method);
  } else if (std::holds_alternative<nn::Interpolation>(method) && !options.sensor.empty() &&
             !is_stream) {
    options.all_rows = load_sensor(options.sensor);
    upsampling.all_rows = options.all_rows;
  }
  Recording recording = Recording::open(path, options);
  // Points go into any number of columns, packets into at most about as many as a turn has.
  if (options.all_rows && !is_stream) recording.use_columns(options.all_rows->columns);
  Upsampler upsampler(recording.sensor(), std::move(method), upsampling, path);
  recording.use_columns(upsampler.recorded().columns);
  if (recording.sensor().columns == upsampler.recorded().columns) {
    options.columns = recording.sensor().columns;
  }
  return {path, std::move(options), std::move(recording), std::move(upsampler)};
}

}  // namespace hqslam::pipeline
