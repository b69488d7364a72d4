#include "upsample/upsampled_input.h"

#include <doctest/doctest.h>

#include <string>

#include "error_message.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/projection.h"
#include "points_file.h"
#include "temporary_directory.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::tools {
namespace {

using namespace hqslam::test;

void write_stack(const std::string& path, int rows, int columns = 1024) {
  NpyStackWriter writer(path, rows, columns);
  RangeImage image(rows, columns);
  image.range_m.assign(image.range_m.size(), 10.0F);
  writer.append(image);
}

struct Files {
  TemporaryDirectory folder;
  std::string weights = folder.file("weights.npz");
  std::string stack_16 = folder.file("stack16.npy");
  std::string stack_64 = folder.file("stack64.npy");
  Files() {
    test::write_untrained_weights(weights, sensor_preset("os1-64"));
    write_stack(stack_16, 16);
    write_stack(stack_64, 64);
  }
};

template <typename... Parts>
bool upsampling_refused_with(const InputChoice& recording, const UpsamplingChoice& upsampling,
                             const Parts&... parts) {
  return refused_with([&] { upsampled_input(recording, upsampling); }, parts...);
}

}  // namespace

TEST_CASE("a stack of the measured rows and one of all rows both find their sensor by themselves") {
  const Files files;
  const UpsampledInput measured = upsampled_input({files.stack_16}, {files.weights});
  CHECK(measured.recorded.beam_elevation_rad == sensor_preset("os1-16").beam_elevation_rad);
  CHECK_FALSE(measured.rows.has_value());
  SensorModel upsampled = sensor_preset("os1-64");
  upsampled.measured_rows = RowSelection{3, 4};
  CHECK(measured.upsampler->sensor() == upsampled);
  CHECK(measured.upsampler->name() == "du-or");

  const UpsampledInput all = upsampled_input({files.stack_64}, {files.weights});
  CHECK(all.recorded == sensor_preset("os1-64"));
  REQUIRE(all.rows.has_value());
  CHECK(all.rows->offset == 3);
  CHECK(all.rows->stride == 4);
}

TEST_CASE("clouds of the measured rows alone find them by their points, those of all rows too") {
  const Files files;
  const auto write_clouds = [&](const std::string& sensor) {
    RangeImage image(sensor_preset(sensor).rows(), 1024);
    image.range_m.assign(image.range_m.size(), 10.0F);
    const std::string path = files.folder.file(sensor + ".pcd");
    write_points(points_of(unproject(image, sensor_preset(sensor), CaptureTime::kMotionCorrected)),
                 path);
    return path;
  };
  const std::string measured = write_clouds("os1-16");
  for (const UpsampledInput& input : {upsampled_input({measured}, {files.weights}),
                                      upsampled_input({measured, "os1-64"}, {files.weights}),
                                      upsampled_input({measured, "os1-64"}, {"linear"})}) {
    CHECK(input.recorded.rows() == 16);
    CHECK_FALSE(input.rows.has_value());
    CHECK(input.upsampler->sensor().rows() == 64);
  }
  const std::string all = write_clouds("os1-64");
  for (const std::string& method : {files.weights, std::string("linear")}) {
    const UpsampledInput input = upsampled_input({all}, {method});
    CHECK(input.recorded.rows() == 64);
    CHECK(input.rows.has_value());
  }
}

TEST_CASE("clouds of another sensor with few beams are refused, named or not") {
  const Files files;
  const SensorModel sensor = sensor_preset("vlp-16");
  RangeImage image(sensor.rows(), sensor.columns);
  image.range_m.assign(image.range_m.size(), 10.0F);
  const std::string path = files.folder.file("cloud.pcd");
  write_points(points_of(unproject(image, sensor, CaptureTime::kMotionCorrected)), path);
  for (const char* name : {"", "os1-64"}) {
    CHECK(upsampling_refused_with({path, name}, {files.weights}, "os1-64", "'vlp-16' (16 x"));
  }
  CHECK(upsampling_refused_with({path, "os1-64"}, {"linear"}, "os1-64", "'vlp-16' (16 x"));
  CHECK(upsampling_refused_with({path, "os1-64"}, {}, "64 rows", "'vlp-16' with 16"));
  CHECK(upsampled_input({path, "os1-16"}, {}).recorded.rows() == 16);
}

TEST_CASE("the sensor of the measured rows may be named by its own name or by that of all rows") {
  const Files files;
  for (const char* name : {"os1-16", "os1-64"}) {
    CAPTURE(name);
    for (const std::string& method : {files.weights, std::string("linear")}) {
      if (method == "linear" && std::string(name) == "os1-16") {
        continue;  // interpolation has no other way to know all rows
      }
      const UpsampledInput plan = upsampled_input({files.stack_16, name}, {method});
      CHECK(plan.recorded.rows() == 16);
      CHECK_FALSE(plan.rows.has_value());
      CHECK(plan.upsampler->sensor().rows() == 64);
    }
  }
}

TEST_CASE("a sensor like the weights' keeps its own beam table where it has all rows") {
  const Files files;
  SensorModel own = sensor_preset("os1-64");
  for (double& elevation_rad : own.beam_elevation_rad) {
    elevation_rad += 0.002;  // 0.11 degrees
  }
  own.name = "own";
  write_sensor_json(own, files.folder.file("own.json"));
  const UpsampledInput plan =
      upsampled_input({files.stack_64, files.folder.file("own.json")}, {files.weights});
  CHECK(plan.upsampler->sensor().name == "own");
}

TEST_CASE(
    "a sensor of the measured rows alone keeps its rate and its limits when it is upsampled") {
  const Files files;
  SensorModel twice_as_fast = sensor_preset("os1-16");
  twice_as_fast.scan_period_s = 0.05;
  twice_as_fast.min_range_m = 0.8;
  twice_as_fast.max_range_m = 200.0;
  InputChoice choice{files.stack_16};
  choice.sensor = files.folder.file("fast.json");
  write_sensor_json(twice_as_fast, choice.sensor);
  const UpsampledInput input = upsampled_input(choice, {files.weights});
  const SensorModel& upsampled = input.upsampler->sensor();
  CHECK(upsampled.rows() == 64);
  CHECK(upsampled.scan_period_s == 0.05);
  CHECK(upsampled.min_range_m == 0.8);
  CHECK(upsampled.max_range_m == 200.0);
}

TEST_CASE("interpolation looks at every fourth row, or at as many as it is told") {
  const Files files;
  CHECK(upsampled_input({files.stack_64, "os1-64"}, {"nearest"}).rows->stride == 4);
  CHECK(upsampled_input({files.stack_64, "os1-64"}, {"inverse", 32}).rows->stride == 2);
}

TEST_CASE("rows of a sensor that all were measured are not thinned and filled without a word") {
  const Files files;
  CHECK(upsampling_refused_with({files.stack_16, "os1-16"}, {"linear"}, "all 16 rows",
                                "nothing between them", "os1-64"));
  CHECK(upsampled_input({files.stack_16, "os1-16"}, {"linear", 4}).rows->stride == 4);
}

TEST_CASE("a sensor that the weights were not made for is one line that says what they expect") {
  const Files files;
  CHECK(upsampling_refused_with({files.stack_64, "hdl-64e"}, {files.weights}, "os1-64", "hdl-64e"));
  CHECK(
      upsampling_refused_with({files.stack_16, "vlp-16"}, {files.weights}, "16 x 1024", "vlp-16"));
  CHECK(upsampling_refused_with({files.stack_64}, {files.weights, 32}, "16 measured rows", "32"));
  CHECK(upsampling_refused_with({files.stack_64}, {"linear"}, "--sensor", "stack64"));
  CHECK(upsampling_refused_with({files.stack_16, "os1-64"}, {"linear", 32}, "16 rows", "32"));
  CHECK(upsampling_refused_with({files.stack_64}, {files.stack_64}, "stack64"));
}

TEST_CASE("a sender whose beams are still to come is refused for its rows alone") {
  const Files files;
  const UpsamplingChoice upsampling{files.weights};
  Sender sender{"--sensor os1-16", {}};
  for (const char* name : {"os1-16", "os1-64"}) {
    sender.sensor = sensor_preset(name);
    for (double& elevation_rad : sender.sensor.beam_elevation_rad) elevation_rad -= 0.02;
    sender.knows_beams = true;
    CHECK(refused_with([&] { upsampled_sender(sender, upsampling); }, "os1-64", name));
    sender.knows_beams = false;
    CHECK_NOTHROW(upsampled_sender(sender, upsampling));
  }
  sender.sensor = sensor_preset("hdl-32e");
  CHECK(refused_with([&] { upsampled_sender(sender, upsampling); }, "os1-64", "hdl-32e"));
  // Twice as fast as the weights want: every second column would be empty.
  sender.sensor = sensor_preset("os1-16");
  sender.sensor.columns = 512;
  CHECK(refused_with([&] { upsampled_sender(sender, upsampling); }, "expects 1024 columns a turn",
                     "has 512"));
}

TEST_CASE("rows that nothing fills are looked at alone, all of them where none are chosen") {
  const Files files;
  const UpsampledInput few = upsampled_input({files.stack_64, "os1-64"}, {"", 16});
  CHECK(few.seen().rows() == 16);
  CHECK(few.measured(OrganizedCloud(64, 8)).rows == 16);
  UpsampledInput all = upsampled_input({files.stack_64, "os1-64"}, {});
  CHECK_FALSE(all.rows.has_value());
  CHECK(all.seen() == sensor_preset("os1-64"));
  CHECK(all.open()->size() == 1);
}

}  // namespace hqslam::tools
