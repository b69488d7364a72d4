#include "hqslam/core/sensor_model.h"

#include <climits>

#include "hqslam/core/angles.h"
#include "hqslam/core/organized_cloud.h"
#include "testing.h"

TEST_CASE("every preset is valid with the rows of its name; others are refused with the list") {
  const std::vector<std::pair<std::string, int>> expected = {
      {"os1-64", 64}, {"os1-16", 16},  {"hdl-64e", 64}, {"hdl-32e", 32},
      {"vlp-16", 16}, {"vlp-32c", 32}, {"vls-128", 128}};
  CHECK(sensor_preset_names().size() == expected.size());
  for (const auto& [name, rows] : expected) {
    const SensorModel sensor = sensor_preset(name);
    CHECK(sensor.rows() == rows);
    CHECK(sensor.name == name);
    CHECK_NOTHROW(validate(sensor));
  }
  CHECK_THROWS_WITH_AS(sensor_preset("os2"),
                       "unknown sensor 'os2': expected one of os1-64, os1-16, hdl-64e, hdl-32e, "
                       "vlp-16, vlp-32c, vls-128 or a .json file",
                       Error);
}

TEST_CASE("16 of 64 rows are 3, 7, ..., 63") {
  const RowSelection rows = selection_for(64, 16);
  CHECK(rows.offset == 3);
  CHECK(rows.stride == 4);
  const SensorModel all = sensor_preset("os1-64");
  const SensorModel some = select_rows(all, rows);
  REQUIRE(some.rows() == 16);
  CHECK(some.beam_elevation_rad.front() == all.beam_elevation_rad[3]);
  CHECK(some.beam_elevation_rad.back() == all.beam_elevation_rad[63]);
  CHECK(some.beam_azimuth_offset_rad[1] == all.beam_azimuth_offset_rad[7]);
  CHECK_THROWS_AS(selection_for(64, 17), Error);
  CHECK_THROWS_AS(selection_for(64, 0), Error);
}

TEST_CASE("a selection that does not fit is refused by sensors, images and clouds alike") {
  const SensorModel sensor = sensor_preset("vlp-16");
  const RangeImage image(16, 32);
  const OrganizedCloud cloud(16, 32);
  for (const RowSelection rows : {RowSelection{0, 0}, {3, -1}, {-1, 2}, {16, 2}, {INT_MAX, 1}}) {
    CAPTURE(rows.offset);
    CHECK_THROWS_AS(select_rows(sensor, rows), Error);
    CHECK_THROWS_AS(select_rows(image, rows), Error);
    CHECK_THROWS_AS(select_rows(cloud, rows), Error);
  }
  CHECK_THROWS_WITH_AS(select_rows(RangeImage(3, 32), {10, 2}),
                       "row selection 10:2 does not fit 3 rows: expected an offset of 0 to 2 and a "
                       "stride of 1 or more",
                       Error);
}

TEST_CASE("a stride beyond the last row leaves one row") {
  const RowSelection rows{3, INT_MAX};
  CHECK(select_rows(sensor_preset("vlp-16"), rows).rows() == 1);
  CHECK(select_rows(RangeImage(16, 32), rows).range_m.size() == 32);
  CHECK(select_rows(OrganizedCloud(16, 32), rows).points_m.size() == 32);
}

TEST_CASE("a selection of rows keeps in mind which of them were measured") {
  SensorModel upsampled = sensor_preset("os1-64");
  upsampled.measured_rows = RowSelection{3, 4};
  const auto measured_of = [&](int offset, int stride) {
    return select_rows(upsampled, {offset, stride}).measured_rows;
  };
  CHECK(measured_of(3, 4) == std::nullopt);  // all of them
  CHECK(measured_of(7, 8) == std::nullopt);
  CHECK(measured_of(1, 2) == RowSelection{1, 2});
  CHECK(measured_of(0, 1) == RowSelection{3, 4});
  CHECK(measured_of(0, 3) == RowSelection{1, 4});
  CHECK(measured_of(0, 63) == RowSelection{1, 2});  // rows 0 and 63
  CHECK_THROWS_AS(select_rows(upsampled, {2, 4}), Error);
}

TEST_CASE("column 0 looks backwards, the middle column forward, azimuth falls with the column") {
  const SensorModel sensor = sensor_preset("vlp-16");
  CHECK(degrees(sensor.azimuth_rad(0, 0)) == doctest::Approx(179.9));
  CHECK(degrees(sensor.azimuth_rad(0, 899)) == doctest::Approx(0.1));
  CHECK(degrees(sensor.azimuth_rad(0, 450)) == doctest::Approx(89.9));
}

TEST_CASE("a direction's column is the pixel whose centre is nearest") {
  for (const char* name : {"os1-64", "vls-128", "hdl-64e"}) {
    const SensorModel sensor = sensor_preset(name);
    const double step_rad = sensor.column_step_rad();
    for (int row = 0; row < sensor.rows(); row += 5) {
      for (int column = 0; column < sensor.columns; column += 7) {
        const double azimuth_rad = sensor.azimuth_rad(row, column);
        CHECK(sensor.column_of(row, azimuth_rad) == column);
        CHECK(sensor.column_of(row, azimuth_rad + 0.49 * step_rad) == column);
        CHECK(sensor.column_of(row, azimuth_rad - 0.49 * step_rad) == column);
        CHECK(sensor.column_of(row, azimuth_rad + 4.0 * std::numbers::pi) == column);
      }
    }
  }
}

TEST_CASE("azimuth offsets split into whole columns and at most half a column") {
  const SensorModel sensor = sensor_preset("os1-64");
  for (int row = 0; row < sensor.rows(); ++row) {
    CHECK(std::abs(sensor.residual_azimuth_rad(row)) <= sensor.column_step_rad() / 2 + 1e-12);
    CHECK(sensor.column_shift(row) * sensor.column_step_rad() + sensor.residual_azimuth_rad(row) ==
          doctest::Approx(sensor.beam_azimuth_offset_rad[row]));
    // The beam that fires from a column looks where the head plus its offset looks.
    const int head_column = sensor.firing_column(row, 500);
    const double head_rad = std::numbers::pi - (head_column + 0.5) * sensor.column_step_rad();
    CHECK(head_rad + sensor.beam_azimuth_offset_rad[row] ==
          doctest::Approx(sensor.azimuth_rad(row, 500)));
  }
  // The first beam looks 3.12 degrees clockwise of the head: 9 columns of 0.3516 degrees.
  CHECK(sensor.column_shift(0) == -9);
}

TEST_CASE("each row is measured once per column") {
  const SensorModel sensor = sensor_preset("os1-64");
  std::set<int> heads;
  for (int column = 0; column < sensor.columns; ++column) {
    heads.insert(sensor.firing_column(0, column));
  }
  CHECK(heads.size() == 1024);
  CHECK(*heads.rbegin() == 1023);
}

TEST_CASE("validation names the field, the value and the constraint") {
  SensorModel sensor = sensor_preset("vlp-16");
  sensor.columns = 3;
  CHECK_THROWS_WITH_AS(validate(sensor), "sensor 'vlp-16': columns is 3, expected 16 to 16384",
                       Error);
  const auto is_refused = [](const auto& change) {
    SensorModel changed = sensor_preset("vlp-16");
    change(changed);
    return error_message([&] { validate(changed); }) != "no Error";
  };
  for (const int columns : {16, 16384, 16385}) {
    CHECK(is_refused([&](SensorModel& s) { s.columns = columns; }) == (columns > 16384));
  }
  CHECK(is_refused(
      [](SensorModel& s) { std::swap(s.beam_elevation_rad[3], s.beam_elevation_rad[4]); }));
  CHECK(is_refused([](SensorModel& s) { s.beam_azimuth_offset_rad.pop_back(); }));
  CHECK(is_refused([](SensorModel& s) { s.beam_elevation_rad[0] = std::nan(""); }));
  for (const RowSelection rows : {RowSelection{0, 0}, {-1, 4}, {16, 4}}) {
    CHECK(is_refused([&](SensorModel& s) { s.measured_rows = rows; }));
  }
  // A turn takes a millisecond to a hundred seconds.
  for (const double period_s : {1e-300, 0.0, -0.1, 1e300, std::nan(""), 0.001}) {
    CHECK(is_refused([&](SensorModel& s) { s.scan_period_s = period_s; }) == (period_s != 0.001));
  }
}

TEST_CASE("rows between beams are evenly spaced above each, at the top as far apart as below it") {
  SensorModel sensor = sensor_preset("vlp-16");
  sensor.beam_elevation_rad = radians({10.0, 6.0, 5.0});
  sensor.beam_azimuth_offset_rad = {0.01, 0.02, 0.03};
  const SensorModel all = with_rows_between(sensor, 2);
  const std::vector<double> expected = radians({12.0, 10.0, 8.0, 6.0, 5.5, 5.0});
  REQUIRE(all.rows() == 6);
  for (int row = 0; row < 6; ++row) {
    CHECK(all.beam_elevation_rad[row] == doctest::Approx(expected[row]));
  }
  CHECK(select_rows(all, {1, 2}).beam_elevation_rad == sensor.beam_elevation_rad);
  CHECK(all.beam_azimuth_offset_rad[3] == 0.02);
  CHECK_NOTHROW(validate(all));
  CHECK_THROWS_AS(with_rows_between(sensor, 1), Error);
}
