#include "pages/drive_scans.h"

#include "tools/page_data.h"

namespace hqslam::tools {

TEST_CASE("a scan's code has units of 4 bits: gaps, and steps from number to number") {
  const std::vector<float> time_offset_s = {0.0F, std::numeric_limits<float>::quiet_NaN(), 3e-4F};
  // 5 rows of 3 columns
  const std::vector<std::uint16_t> range = {3, 0, 0, 6, 6, 5, 0, 65535, 0, 0, 0, 0, 0, 0, 0};
  ViewDrive drive{sensor_preset("os1-64"), {}};
  drive.scans.emplace_back().range = range;
  drive.scans[0].time_offset_s = time_offset_s;
  const nlohmann::json scan = drive_json(drive)["scans"][0];
  CHECK(scan["columns"] == 3);
  // Steps 0, -, 3; 0, -, -; 3, 0, -1; -, 65530 = 0o377765 as 1 + 2 n, ...
  CHECK(bytes_of(scan["code"]) ==
        std::vector<std::uint8_t>{0x01, 0x17, 0x00, 0x17, 0x02, 0xED, 0xFF, 0x3F, 0, 0, 0, 0});
}

TEST_CASE("rows of a drive have the elevation of their calibration, and whether it is measured") {
  ViewDrive drive{sensor_preset("os1-64"), {}};
  drive.sensor.measured_rows = RowSelection{3, 4};
  drive.sensor.elevation_correction_rad.assign(64, 0.01);
  const nlohmann::json row = drive_json(drive)["rows"][3];
  CHECK(row["elevation_rad"].get<double>() ==
        doctest::Approx(drive.sensor.beam_elevation_rad[3] + 0.01));
  CHECK(row["measured"] == true);
  CHECK(drive_json(drive)["rows"][2]["measured"] == false);
  CHECK(drive_json(drive)["max_range_m"] == 120.0);
}

}  // namespace hqslam::tools
