#include "hqslam/core/imu_sample.h"

#include "files/scan_files.h"
#include "made_scans.h"

using namespace hqslam::recordings;

namespace {

std::vector<ImuSample> samples_of(const std::string& csv) {
  return from_file("imu.csv", csv, read_imu_csv);
}

}  // namespace

TEST_CASE("lines of seven numbers are samples; a header and empty lines are skipped") {
  const std::vector<ImuSample> samples = samples_of(
      "stamp,wx,wy,wz,fx,fy,fz\n1.5,0.1,-0.2,3e-1,0,0,9.8\n\n1.51, 1, 2, 3, 4, 5, 6\r\n");
  REQUIRE(samples.size() == 2);
  CHECK(samples[0].stamp_s == 1.5);
  CHECK(samples[0].angular_rate_rad_per_s == Eigen::Vector3d(0.1, -0.2, 0.3));
  CHECK(samples[0].specific_force_mps2 == Eigen::Vector3d(0, 0, 9.8));
  CHECK(samples[1].specific_force_mps2 == Eigen::Vector3d(4, 5, 6));
}

TEST_CASE("malformed inertial data are refused, with the line") {
  const auto refused = [](const std::string& text, const char* found) {
    return refused_with([&] { samples_of(text); }, "imu.csv", found);
  };
  CHECK(refused("", "found none"));
  CHECK(refused("stamp,wx,wy,wz,fx,fy,fz\n", "found none"));
  CHECK(refused("1,2,3,4,5,6\n", ":1: expected 7 numbers"));
  CHECK(refused("1,2,3,4,5,6,7,8\n", ":1: expected 7 numbers"));
  CHECK(refused("1,2,3,4,5,6,7\n2,2,3,x,5,6,7\n", ":2: expected 7 numbers"));
  CHECK(refused("1,2,3,4,5,6,nan\n", ":1: expected 7 numbers"));
  CHECK(refused("1,2,3,4,5,6,inf\n", ":1: expected 7 numbers"));
  CHECK(refused("1,2,3,4,5,6,7\n1,2,3,4,5,6,7\n", ":2: expected a stamp after 1 s"));
}

TEST_CASE("every scan has the samples up to its end, each sample once") {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 50; ++k) samples.emplace_back().stamp_s = 0.01 * k;
  const auto source = with_imu(std::make_unique<MadeScans>(scans_at({0.1, 0.2, 0.4})), samples);
  CHECK(source->sensor().name == sensor_preset("vlp-16").name);
  const double half_s = 0.5 * source->sensor().scan_period_s;
  std::size_t given = 0;
  for (const double stamp_s : {0.1, 0.2, 0.4}) {
    const RecordedScan scan = source->next().value();
    for (const ImuSample& sample : scan.imu) CHECK(sample.stamp_s == samples[given++].stamp_s);
    REQUIRE(given < samples.size());
    CHECK(samples[given - 1].stamp_s <= stamp_s + half_s);
    CHECK(samples[given].stamp_s > stamp_s + half_s);
  }
  CHECK(!source->next());
  CHECK(source->warnings().empty());
}

TEST_CASE("samples of another clock than the scans' are named at the end, with both times") {
  const auto warnings = [](double first_s, double last_s) {
    std::vector<ImuSample> samples;
    for (double s = first_s; s <= last_s; s += 0.01) samples.emplace_back().stamp_s = s;
    const auto source =
        with_imu(std::make_unique<MadeScans>(scans_at({0.1, 0.2, 0.3, 0.4})), samples, "imu.csv");
    CHECK(source->warnings().empty());
    while (source->next()) continue;
    return source->warnings();
  };
  CHECK(warnings(0.2, 5.0).empty());  // most scans
  for (const double late_s : {1000.0, -1000.0, 0.35, -0.35}) {
    CAPTURE(late_s);
    const auto said = warnings(0.05 + late_s, 0.45 + late_s);
    REQUIRE(said.size() == 1);
    const bool is_far = std::abs(late_s) > 1.0;
    CHECK(one_line_with(said[0], late_s > 1.0 ? "imu.csv: has samples of 1000.050 to 1000.4" : "",
                        "of 0.100 to 0.400 s", is_far ? ": 0 of 4 scans" : ": 1 of 4 scans"));
  }
}
