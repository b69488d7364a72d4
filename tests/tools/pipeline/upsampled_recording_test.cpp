#include "hqslam/pipeline/upsampled_recording.h"

#include "points_file.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::pipeline {
namespace {

struct Files {
  TemporaryDirectory folder;
  std::string weights = untrained_file();

  std::string stack(int rows) const {
    const std::string path = folder.file(std::to_string(rows) + ".npy");
    write_stack(path, {flat_image(rows, 1024, 10.0F)});
    return path;
  }
  std::string cloud(const char* sensor_name) const {
    const SensorModel sensor = sensor_preset(sensor_name);
    const RangeImage image = flat_image(sensor.rows(), sensor.columns, 10.0F);
    const std::string path = folder.file(std::string(sensor_name) + ".pcd");
    write_points(points_of(unproject(image, sensor, CaptureTime::kMotionCorrected)), path);
    return path;
  }
};

bool is_refused(const std::string& path, const std::string& sensor, const std::string& method,
                const auto&... parts) {
  return refused_with([&] { open_upsampled(path, {.sensor = sensor}, {.method = method}); },
                      parts...);
}

}  // namespace

TEST_CASE("clouds of the measured rows alone find them by their points, those of all rows too") {
  const Files files;
  const std::string measured = files.cloud("os1-16");
  for (const auto& [sensor, method] : {std::pair<std::string, std::string>{"", files.weights},
                                       {"os1-64", files.weights},
                                       {"os1-64", "linear"}}) {
    CAPTURE(method);
    auto opened = open_upsampled(measured, {.sensor = sensor}, {.method = method});
    CHECK_FALSE(opened.upsampler.selected_rows());
    const auto scan = opened.recording.next().value();
    CHECK(scan.cloud.rows == 16);
    CHECK(opened.upsampler.upsampled(opened.upsampler.measured(scan.cloud)).rows == 64);
  }
  for (const std::string& method : {files.weights, std::string("linear")}) {
    CHECK(open_upsampled(files.cloud("os1-64"), {}, {.method = method}).upsampler.selected_rows());
  }
}

TEST_CASE("clouds of another sensor with few beams are refused, named or not") {
  const Files files;
  const std::string path = files.cloud("vlp-16");
  for (const char* name : {"", "os1-64"}) CHECK(is_refused(path, name, files.weights, "vlp-16"));
  CHECK(is_refused(path, "os1-64", "linear", "os1-64", "vlp-16"));
  CHECK(is_refused(path, "os1-64", "", "64 rows", "'vlp-16' with 16"));
  CHECK(is_refused(path, "os1-16", "", "found beams of 'vlp-16'"));  // as many rows
}

TEST_CASE("the sensor of the measured rows may be named by its own name or by that of all rows") {
  const Files files;
  for (const auto& [name, method] : {std::pair<std::string, std::string>{"os1-16", files.weights},
                                     {"os1-64", files.weights},
                                     {"os1-64", "linear"}}) {
    CAPTURE(name);
    const auto opened = open_upsampled(files.stack(16), {.sensor = name}, {.method = method});
    CHECK(opened.upsampler.recorded().rows() == 16);
    CHECK(opened.upsampler.sensor().rows() == 64);
  }
  CHECK(is_refused(files.stack(64), "", "linear", "--sensor", "64.npy"));
  CHECK(is_refused(files.stack(64), "hdl-64e", files.weights, "os1-64", "hdl-64e"));
  CHECK(is_refused(files.stack(64), "", files.stack(64), "64.npy"));
}

}  // namespace hqslam::pipeline
