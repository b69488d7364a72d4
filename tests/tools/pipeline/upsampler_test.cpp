#include "hqslam/pipeline/upsampler.h"

#include "hqslam/core/projection.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::pipeline {
namespace {

/// Whether these options for a drive of this sensor are refused with these parts.
bool refused(const SensorModel& sensor, const UpsamplingOptions& options, const auto&... parts) {
  return refused_with([&] { Upsampler(sensor, options, "drive"); }, parts...);
}

}  // namespace

TEST_CASE("scans of the measured rows and of all rows are upsampled to the same rows") {
  const std::string weights = untrained_file();
  const Upsampler measured(sensor_preset("os1-16"), {.method = weights});
  CHECK(measured.recorded() == sensor_preset("os1-16"));
  CHECK_FALSE(measured.selected_rows());
  SensorModel all_rows = sensor_preset("os1-64");
  all_rows.measured_rows = RowSelection{3, 4};
  CHECK(measured.sensor() == all_rows);
  CHECK(measured.method()->name() == "du-or");

  const Upsampler all(sensor_preset("os1-64"), {.method = weights});
  CHECK(all.selected_rows() == RowSelection{3, 4});
  CHECK(all.measured_sensor().rows() == 16);
  CHECK(all.sensor() == all_rows);

  const Upsampler made_for(UpsamplingOptions{.method = weights});
  CHECK(made_for.recorded().beam_elevation_rad == sensor_preset("os1-16").beam_elevation_rad);
}

TEST_CASE("the sensor's own beams, rate and limits are kept when its scans are upsampled") {
  const std::string weights = untrained_file();
  SensorModel own = sensor_preset("os1-64");
  for (double& elevation_rad : own.beam_elevation_rad) elevation_rad += 0.002;  // 0.11 degrees
  own.name = "own";
  CHECK(Upsampler(own, {.method = weights}).sensor().name == "own");

  SensorModel fast = sensor_preset("os1-16");
  fast.scan_period_s = 0.05;
  fast.min_range_m = 0.8;
  fast.max_range_m = 200.0;
  const SensorModel upsampled = Upsampler(fast, {.method = weights}).sensor();
  CHECK(upsampled.rows() == 64);
  CHECK(upsampled.scan_period_s == 0.05);
  CHECK(upsampled.min_range_m == 0.8);
  CHECK(upsampled.max_range_m == 200.0);
}

TEST_CASE("an interpolation takes every fourth row as measured, or the rows that are asked for") {
  const SensorModel os1_64 = sensor_preset("os1-64");
  CHECK(Upsampler(os1_64, {.method = "nearest"}).selected_rows()->stride == 4);
  CHECK(Upsampler(os1_64, {.method = "inverse", .rows = 32}).selected_rows()->stride == 2);
  const Upsampler alone(select_rows(os1_64, {3, 4}), {.method = "linear", .all_rows = os1_64});
  CHECK_FALSE(alone.selected_rows());
  CHECK(alone.sensor().rows() == 64);
  const SensorModel os1_16 = sensor_preset("os1-16");
  CHECK(refused(os1_16, {.method = "linear"}, "all 16 rows", "nothing between them", "os1-64"));
  CHECK(refused(os1_16, {.method = "linear", .rows = 32, .all_rows = os1_64}, "16 rows", "32"));
  CHECK(Upsampler(os1_16, {.method = "linear", .rows = 4}).selected_rows()->stride == 4);
}

TEST_CASE("a sensor that the weights were not made for is one line with what they expect") {
  const std::string weights = untrained_file();
  const UpsamplingOptions options{.method = weights};
  CHECK(refused(sensor_preset("hdl-64e"), options, "os1-64", "drive is of 'hdl-64e'"));
  CHECK(refused(sensor_preset("vlp-16"), options, "16 x 1024", "vlp-16"));
  CHECK(
      refused(sensor_preset("os1-64"), {.method = weights, .rows = 32}, "16 measured rows", "32"));
  CHECK(
      refused(preset_with("os1-16", 512), options, "expects 1024 columns a turn", "drive has 512"));
  CHECK(refused_with([&] { Upsampler(UpsamplingOptions{.method = "linear"}); }, "weights"));
}

TEST_CASE("scans in more columns than the network's are projected into its columns") {
  const SensorModel fine = preset_with("os1-16", 2048);
  const Upsampler upsampler(fine, {.method = untrained_file()});
  CHECK(upsampler.recorded().columns == 1024);
  const RangeImage image = flat_image(16, fine.columns, 10.0F);
  const OrganizedCloud measured = upsampler.measured(unproject(image, fine, CaptureTime::kRolling));
  CHECK(measured.columns == 1024);
  CHECK(points_of(measured).size() == 16 * 1024);
  CHECK(measured.time_offset_s.size() == measured.range_m.size());
}

TEST_CASE("weights for any sensor get 64 rows out of 16 or 32, twice as many out of more") {
  const std::string file = untrained_file("du-mix", "any_beams");
  const auto rows_of = [&](const SensorModel& sensor, int rows = 0) {
    return Upsampler(sensor, {.method = file, .rows = rows}).sensor().rows();
  };
  CHECK(rows_of(sensor_preset("vlp-16")) == 64);
  CHECK(rows_of(sensor_preset("hdl-32e")) == 64);
  CHECK(rows_of(sensor_preset("os1-64")) == 128);
  CHECK(rows_of(sensor_preset("os1-64"), 16) == 64);
  const SensorModel odd = preset_with("vlp-16", 900);
  Upsampler upsampler(odd, {.method = file});
  CHECK(upsampler.recorded().columns == 896);
  CHECK_FALSE(upsampler.selected_rows());
  CHECK(select_rows(upsampler.sensor(), {3, 4}).beam_elevation_rad == odd.beam_elevation_rad);
  const RangeImage image = flat_image(16, 900, 10.0F);
  const OrganizedCloud measured = upsampler.measured(unproject(image, odd, CaptureTime::kRolling));
  CHECK(upsampler.upsampled(measured).rows == 64);
}

TEST_CASE("a spacing gives as many rows as leave no wider gap, with weights for any sensor alone") {
  const std::string any = untrained_file("du-mix", "any_beams");
  const SensorModel vlp16 = sensor_preset("vlp-16");  // 2 degrees apart
  const auto upsampler = [&](const std::string& method, double spacing_deg, int rows = 0) {
    return Upsampler(vlp16,
                     {.method = method, .rows = rows, .spacing_rad = spacing_deg * kDegree_rad});
  };
  CHECK(upsampler(any, 1.0).sensor().rows() == 32);
  CHECK(upsampler(any, 0.4).sensor().rows() == 80);
  CHECK(upsampler(any, 0.39).sensor().rows() == 96);
  const SensorModel finest = upsampler(any, 0.25).sensor();
  CHECK(finest.rows() == 128);
  CHECK(finest.beam_elevation_rad[8] - finest.beam_elevation_rad[9] ==
        doctest::Approx(0.25 * kDegree_rad));

  CHECK(refused_with([&] { upsampler(any, 0.2); }, "0.25 degrees or more", "found 0.20"));
  CHECK(refused_with([&] { upsampler(any, 2.0); }, "less than", "2.00"));
  CHECK(refused_with([&] { upsampler(any, 0.5, 8); }, "all rows", "leave out the spacing"));
  CHECK(refused_with([&] { upsampler("linear", 0.5); }, "linear", "weights for any sensor"));
  CHECK(refused_with([&] { upsampler(untrained_file(), 0.5); }, "weights for any sensor"));
}

TEST_CASE("rows that nothing fills are selected, all of them where none are asked for") {
  const SensorModel os1_64 = sensor_preset("os1-64");
  const Upsampler few(os1_64, {.rows = 16});
  CHECK(few.sensor().rows() == 16);
  CHECK(few.measured(OrganizedCloud(64, 8)).rows == 16);
  const Upsampler all(os1_64, UpsamplingOptions{});
  CHECK_FALSE(all.selected_rows());
  CHECK(all.sensor() == os1_64);
}

TEST_CASE("weights that come with hqslam are chosen by name and sensor, the laboratory's are not") {
  const std::vector<std::string> names = installed_weights_names();
  for (const char* name : {"du-mix", "du-or"}) CHECK(std::ranges::count(names, name) == 1);
  CHECK(std::ranges::count(names, "srae") == 0);
  const SensorModel hdl_64e = preset_with("hdl-64e", 870);
  CHECK(weights_file("du-mix", hdl_64e, 16).ends_with("/du-mix_real-scans.npz"));
  CHECK(weights_file("du-mix", hdl_64e, 0).ends_with("/du-mix_any-beams.npz"));
  CHECK(Upsampler(hdl_64e, {.method = "du-mix", .rows = 16}).sensor().rows() == 64);
  CHECK(Upsampler(hdl_64e, {.method = "du-mix"}).sensor().rows() == 128);
  const Upsampler hdl_32e(sensor_preset("hdl-32e"), {.method = "du-mix"});
  CHECK(fits_any_sensor(hdl_32e.method()->network()->description()));
  CHECK(refused(sensor_preset("hdl-32e"), {.method = "du-or"}, "du-or", "hdl-64e",
                "none for 'hdl-32e'"));
  CHECK(refused_with([] { load_method({.method = "du-or"}); }, "name the sensor"));
}

}  // namespace hqslam::pipeline
