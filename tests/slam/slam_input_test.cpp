#include "hqslam/slam/slam.h"
#include "slam/yard_drive.h"

using namespace hqslam::slam;

TEST_CASE("a drive is tracked to centimetres whatever the clock does") {
  const std::pair<const char*, double (*)(int scan)> clocks[] = {
      {"equal or falling", [](int i) { return i < 15 ? 1.0 : 0.5; }},
      {"every fifth scan right after the one before",
       [](int i) { return kDrivePeriod_s * i - (i % 5 == 4 ? 0.0999 : 0.0); }},
      {"from the time since the start to that of day, and back",
       [](int i) { return kDrivePeriod_s * i + (i >= 10 && i < 20 ? 1.7e9 : 0.0); }}};
  const SensorModel sensor = small_sensor(16, 512);
  for (const auto& [clock, stamp_s] : clocks) {
    const std::string of_clock = clock;
    CAPTURE(of_clock);
    Slam slam(sensor);
    int not_ok = 0;
    for (int i = 0; i < 30; ++i) {
      const auto report = slam.process(drive_scan(sensor, i), stamp_s(i));
      CHECK(report.stamp_s == stamp_s(i));
      not_ok += report.mapping_status != Status::kOk;
    }
    CHECK(worst_error_m(slam.trajectory()) < 0.15);
    CHECK(not_ok <= 4);
  }
}

TEST_CASE("a stamp that is no time in seconds is refused, and nothing has changed") {
  const SensorModel sensor = small_sensor(16, 512);
  Slam slam(sensor);
  for (int i = 0; i < 6; ++i) {
    const OrganizedCloud scan = drive_scan(sensor, i);
    for (const double stamp : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1.7e18}) {
      CHECK_THROWS_AS(slam.process(scan, stamp), Error);
    }
    slam.process(scan, i * kDrivePeriod_s);
  }
  CHECK(slam.trajectory().size() == 6);
  CHECK(worst_error_m(slam.trajectory()) < 0.15);
}

TEST_CASE("a pixel whose point, range or capture time is not finite is no return") {
  const SensorModel sensor = small_sensor(16, 512);
  Slam slam(sensor);
  Slam slam_without(sensor);
  for (int i = 0; i < 10; ++i) {
    OrganizedCloud cloud = drive_scan(sensor, i);
    OrganizedCloud without = cloud;
    for (std::size_t k = 0; k < cloud.range_m.size(); k += 97) {
      const float wrong = k % 2 == 0 ? std::nanf("") : HUGE_VALF;
      if (k % 3 == 0) cloud.time_offset_s[k] = wrong;
      if (k % 3 != 0) cloud.range_m[k] = wrong;
      if (k % 3 != 0) cloud.points_m[k].setConstant(std::nanf(""));
      without.range_m[k] = 0.0F;
    }
    const auto report = slam.process(cloud, i * kDrivePeriod_s);
    const auto expected = slam_without.process(without, i * kDrivePeriod_s);
    CHECK(report.returns == expected.returns);
    CHECK(report.T_map_sensor.matrix() == expected.T_map_sensor.matrix());
  }
  CHECK(worst_error_m(slam.trajectory()) < 0.15);
}

TEST_CASE("capture times that are no offsets from the middle of the scan in seconds are refused") {
  const SensorModel sensor = small_sensor(16, 512);
  Slam slam(sensor);
  const OrganizedCloud sound = drive_scan(sensor, 0);
  const auto changed = [&](float factor, float shift_s) {
    OrganizedCloud cloud = sound;
    for (float& offset_s : cloud.time_offset_s) offset_s = factor * offset_s + shift_s;
    return cloud;
  };
  const auto period_s = static_cast<float>(sensor.scan_period_s);
  const auto refused = [&](const OrganizedCloud& cloud) {
    return refused_with([&] { slam.process(cloud, 0.0); }, "capture times", "middle of the scan");
  };
  CHECK(refused(changed(1.0F, period_s / 2.0F)));   // from its beginning
  CHECK(refused(changed(1.0F, -period_s / 2.0F)));  // from its end
  CHECK(refused(changed(1.0F, 1.6e9F)));            // no offsets at all
  CHECK(refused(changed(1000.0F, 0.0F)));           // milliseconds
  CHECK_THROWS_AS(slam.process(changed(1e6F, 0.0F), 0.0), ScanError);
  CHECK(slam.trajectory().empty());
  CHECK_NOTHROW(slam.process(changed(1.0F, period_s / 10.0F), 0.0));
  CHECK_NOTHROW(slam.process(changed(1.5F, 0.0F), 0.1));  // a head that is slower than its model
  OrganizedCloud half = changed(1.0F, 0.0F);              // returns of one half of the turn alone
  for (std::size_t k = 0; k < half.range_m.size(); ++k) {
    if (half.time_offset_s[k] < 0.0F) half.range_m[k] = 0.0F;
  }
  CHECK_NOTHROW(slam.process(half, 0.2));
  const OrganizedCloud timeless = changed(std::numeric_limits<float>::quiet_NaN(), 0.0F);
  CHECK(refused_with([&] { slam.process(timeless, 0.3); }, "capture times", "finite"));
  // The times of pixels without a return do not matter.
  OrganizedCloud cloud = sound;
  cloud.range_m[5] = 0.0F;
  cloud.time_offset_s[5] = 1e9F;
  CHECK_NOTHROW(slam.process(cloud, 0.3));
}

TEST_CASE("scans of another shape, incomplete ones and an empty sensor are refused") {
  const std::pair<const char*, void (*)(OrganizedCloud&)> faults[] = {
      {"another shape", [](OrganizedCloud& cloud) { cloud = OrganizedCloud(64, 512); }},
      {"a point too few", [](OrganizedCloud& cloud) { cloud.points_m.pop_back(); }},
      {"a range too many", [](OrganizedCloud& cloud) { cloud.range_m.push_back(1.0F); }},
      {"one capture time", [](OrganizedCloud& cloud) { cloud.time_offset_s.resize(1); }},
      {"one intensity", [](OrganizedCloud& cloud) { cloud.intensity.resize(1); }}};
  SensorModel sensor = small_sensor(16, 512);
  Slam slam(sensor);
  const OrganizedCloud sound = drive_scan(sensor, 0);
  for (const auto& [fault, make] : faults) {
    const std::string of_scan = fault;
    CAPTURE(of_scan);
    OrganizedCloud cloud = sound;
    make(cloud);
    CHECK_THROWS_AS(slam.process(cloud, 0.0), Error);
  }
  CHECK_NOTHROW(slam.process(sound, 0.0));
  CHECK(slam.trajectory().size() == 1);
  sensor.columns = 0;
  CHECK_THROWS_AS(Slam{sensor}, Error);
}
