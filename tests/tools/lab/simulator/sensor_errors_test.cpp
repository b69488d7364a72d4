#include "hqslam/sim/sensor_errors.h"

#include <nlohmann/json.hpp>

#include "hqslam/sim/write_drive.h"
#include "lidar.h"
#include "sample_statistics.h"
#include "small_city.h"

using namespace hqslam::sim;

namespace {

DriveSpec drive_with(SensorErrors errors) { return {"block", 1, 2, {}, {}, errors}; }

City city_with_wall() {
  City city = empty_city();
  add_wall(city.fixed, 10.0, -60.0, 60.0);
  return city;
}

/// A bad sensor, 10 m before a wall.
struct BeforeWall {
  City city = city_with_wall();
  RayScene scene{city};
  SensorModel sensor = small_sensor();
  std::vector<Pose> poses = std::vector(static_cast<std::size_t>(sensor.columns), Pose::Identity());
  DriveSpec spec = drive_with(SensorErrors::kBad);
  Lidar lidar{sensor, spec};
  BeamErrors beams = draw_beam_errors(spec.sensor_errors, sensor.rows(), spec.seed);

  /// Of the angle at which the beam of a pixel meets the wall.
  double cosine(int row, int column) const {
    return std::cos(sensor.beam_elevation_rad[row] + beams.elevation_rad[row]) *
           std::cos(sensor.azimuth_rad(row, column) + beams.azimuth_rad[row]);
  }
};

}  // namespace

TEST_CASE("errors of beams are drawn from the seed: no mean, the stated size and bound") {
  for (const SensorErrors errors : {SensorErrors::kTypical, SensorErrors::kBad}) {
    const bool bad = errors == SensorErrors::kBad;
    std::vector<double> range_m, elevation_rad, azimuth_rad, brighter;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const BeamErrors beams = draw_beam_errors(errors, 64, seed);
      CHECK(beams.range_m == draw_beam_errors(errors, 64, seed).range_m);
      CHECK(beams.range_m != draw_beam_errors(errors, 64, seed + 1).range_m);
      range_m.insert(range_m.end(), beams.range_m.begin(), beams.range_m.end());
      azimuth_rad.insert(azimuth_rad.end(), beams.azimuth_rad.begin(), beams.azimuth_rad.end());
      for (const double gain : beams.intensity_gain) brighter.push_back(gain - 1.0);
      const auto middle = beams.elevation_rad.begin() + 32;
      const double upper = std::accumulate(beams.elevation_rad.begin(), middle, 0.0) / 32.0;
      const double lower = std::accumulate(middle, beams.elevation_rad.end(), 0.0) / 32.0;
      CHECK(std::abs(std::abs(upper - lower) - (bad ? 0.3 : 0.0) * kDegree_rad) <
            0.05 * kDegree_rad);
      for (std::size_t row = 0; row < 64; ++row) {
        elevation_rad.push_back(beams.elevation_rad[row] -
                                (bad ? std::copysign(0.15, row < 32 ? upper : lower) : 0.0) *
                                    kDegree_rad);
      }
    }
    // A normal distribution that is cut off at two sigma has 0.880 of its deviation left.
    const auto check = [](const std::vector<double>& values, double sigma) {
      CHECK(std::abs(mean_of(values)) < 0.05 * sigma);
      CHECK(deviation_of(values) == doctest::Approx(0.880 * sigma).epsilon(0.02));
      for (const double value : values) REQUIRE(std::abs(value) < 2.0001 * sigma);
    };
    check(range_m, bad ? 0.03 : 0.015);
    check(elevation_rad, 0.05 * kDegree_rad);
    check(azimuth_rad, 0.05 * kDegree_rad);
    check(brighter, bad ? 0.15 : 0.05);
  }
  CHECK(draw_beam_errors(SensorErrors::kNone, 3, 1).intensity_gain == std::vector<double>(3, 1.0));
  CHECK(draw_beam_errors(SensorErrors::kNone, 3, 1).elevation_rad == std::vector<double>(3, 0.0));
}

TEST_CASE("a slanting or a bright surface is reported nearer, a faint one farther, by hand") {
  const PulseErrors errors{.incidence_share = 0.25, .walk_m = 0.01, .signal_share = 0.7};
  // 0.25 * 20 m * 0.0015 * tan 60 degrees = 13.0 mm; at a signal of 4 there is no walk.
  const Echo slanting = with_errors({20.0, 4.0}, 0.5, errors);
  CHECK(slanting.range_m == doctest::Approx(20.0 - 0.01299).epsilon(1e-6));
  CHECK(slanting.signal == doctest::Approx(2.8));
  CHECK(with_errors({60.0, 4.0}, 0.0, errors).range_m == doctest::Approx(59.8));
  CHECK(with_errors({20.0, 12.0}, 1.0, errors).range_m == doctest::Approx(19.995));
  CHECK(with_errors({20.0, 0.0}, 1.0, errors).range_m == doctest::Approx(20.01));
  CHECK(with_errors({20.0, 3.3}, 0.3, {}).range_m == 20.0);
}

TEST_CASE("of the echoes at an edge a share is between the surfaces, if these are close") {
  const auto share_between = [](double far_m) {
    Footprint footprint;
    footprint.add({10.0, 4.0}, 2.0);
    footprint.add({far_m, 4.0}, 1.0);
    int between = 0;
    for (std::uint64_t k = 0; k < 5000; ++k) {
      const double range_m = footprint.reported_echo(0.1, seed_of(5, k))->range_m;
      between += range_m > 10.0 && range_m < far_m ? 1 : 0;
    }
    return between / 5000.0;
  };
  CHECK(share_between(11.5) == doctest::Approx(0.1).epsilon(0.1));
  CHECK(share_between(12.5) == 0.0);
}

TEST_CASE("before a wall each beam is off by what was drawn for it, as bright as its gain says") {
  constexpr int kScans = 60;
  const BeforeWall bad;
  std::vector<RangeImage> images;
  std::vector<std::vector<std::uint8_t>> intensities(kScans);
  for (int scan = 0; scan < kScans; ++scan) {
    images.push_back(bad.lidar.measure(bad.scene, bad.poses, scan, {}, &intensities[scan]));
  }
  for (int row = 0; row < bad.sensor.rows(); ++row) {
    const auto beam = static_cast<std::size_t>(row);
    std::vector<double> errors_m;
    std::vector<double> scatter;
    for (int scan = 0; scan < kScans; ++scan) {
      for (int column = 60; column < 68; ++column) {
        if (images[scan].at(row, column) == 0.0F) continue;
        const double cosine = bad.cosine(row, column);
        const Echo echo = *echo_of({10.0 / cosine, cosine, {Material::kPlaster, 255}}, 120.0, {});
        const double expected_m =
            with_errors(echo, cosine, pulse_errors(SensorErrors::kBad)).range_m +
            bad.beams.range_m[beam];
        errors_m.push_back(static_cast<double>(images[scan].at(row, column)) - expected_m);
        // Half of the signal comes back; plaster reflects 70 % head-on.
        const double unscattered = 0.5 * 70.0 * std::pow(cosine, 0.375);
        const double gain = bad.beams.intensity_gain[beam];
        scatter.push_back(
            intensities[scan][images[scan].index(row, column)] / (gain * unscattered) - 1.0);
      }
    }
    CHECK(errors_m.size() > 400);
    CHECK(std::abs(mean_of(errors_m)) < 0.002);
    CHECK(std::abs(mean_of(scatter)) < 0.04);
    CHECK(deviation_of(scatter) == doctest::Approx(0.2).epsilon(0.15));
  }
}

TEST_CASE("a drive keeps its sensor's table and says beside it how its beams really look") {
  const TemporaryDirectory folder;
  for (const SensorErrors errors : {SensorErrors::kNone, SensorErrors::kTypical}) {
    const std::string out = folder.file(name_of(errors));
    DriveWriter(out, drive_with(errors), small_sensor());
    CHECK(read_drive_json(out + "/drive.json").sensor_errors == errors);
  }
  const auto text = [&](const std::string& file) { return file_contents(folder.file(file)); };
  CHECK(text("none/sensor.json") == text("typical/sensor.json"));
  CHECK(text("none/drive.json").find("sensor_errors") == std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder.file("none/sensor_errors.json")));
  const auto truth = nlohmann::json::parse(text("typical/sensor_errors.json"));
  const BeamErrors beams = draw_beam_errors(SensorErrors::kTypical, 16, 1);
  CHECK(truth["range_m"] == beams.range_m);
  CHECK(truth["elevation_deg"][3].get<double>() * kDegree_rad ==
        doctest::Approx(beams.elevation_rad[3]));
  CHECK(truth["azimuth_deg"].size() == 16);
  CHECK(truth["intensity_gain"] == beams.intensity_gain);
  CHECK(DriveSimulator(drive_with(SensorErrors::kTypical), small_sensor()).next()->image.range_m !=
        DriveSimulator(drive_with(SensorErrors::kNone), small_sensor()).next()->image.range_m);
  CHECK(refused_with([] { sensor_errors_named("awful"); }, "awful", "typical"));
}
