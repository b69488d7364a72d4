#include "hqslam/core/left_out.h"
#include "recording_complaint.h"
#include "vlp16_files.h"

using namespace hqslam::recordings;

// The sensor of scans that are files of points, and units of it that are off its table.

namespace {

/// Four scans of a VLP-16 whose rings are numbered so, 0 the lowest; beams under these stay out.
void write_numbered(const TemporaryDirectory& folder, const std::function<int(int)>& number,
                    const SensorModel& sensor = sensor_preset("vlp-16"), int every = 1) {
  write_scans(folder, 4, [&](int scan) {
    std::string text = "x y z ring\n";
    for (int step = 0; step < 900; ++step) {
      for (int ring = 0; ring < sensor.rows(); ring += every) {
        const double elevation_rad = sensor.beam_elevation_rad[sensor.rows() - 1 - ring];
        const Eigen::Vector3d p =
            (5.0 + 0.1 * scan) * direction_of(-(step + 0.5) * kTwoPi / 900, elevation_rad);
        text += fmt::format("{} {} {} {}\n", p.x(), p.y(), p.z(), number(ring));
      }
    }
    return text;
  });
}

}  // namespace

TEST_CASE("stamps of every turn give the rate of turning, those of several turns do not") {
  const TemporaryDirectory folder;
  write_numbered(folder, [](int ring) { return ring; });
  for (const auto& [step_s, period_s] :
       {std::pair(0.05, 0.05), {0.1, 0.1}, {0.2, 0.1}, {0.5, 0.1}}) {
    CAPTURE(step_s);
    std::string stamps;
    for (int scan = 0; scan < 4; ++scan) stamps += fmt::format("{}\n", scan * step_s);
    const TemporaryDirectory beside;
    write_file(beside.file("stamps.txt"), stamps);
    const auto recording =
        Recording::open(folder.path(), {.files = {.stamps = beside.file("stamps.txt")}});
    CHECK(recording.sensor().scan_period_s == doctest::Approx(period_s));
  }
}

TEST_CASE("rings that are numbered from 1, or in steps, are those of the sensor in their order") {
  for (const auto& [first, step] : {std::pair(1, 1), {0, 2}, {3, 4}}) {
    CAPTURE(first);
    const TemporaryDirectory folder;
    write_numbered(folder, [=](int ring) { return first + step * ring; });
    for (const std::string name : {"", "vlp-16"}) {
      auto recording = Recording::open(folder.path(), {.sensor = name});
      CHECK(recording.sensor().rows() == 16);
      const auto scan = recording.next().value();
      CHECK(scan.counts.kept > 16 * 800);
      CHECK(scan.cloud.points_m[scan.cloud.index(0, 450)].z() > 1.0F);
    }
  }
}

TEST_CASE("of a sensor of which only every fourth beam has points only those rows are read") {
  const TemporaryDirectory folder;
  write_numbered(
      folder, [](int ring) { return ring; }, sensor_preset("os1-64"), 4);
  auto recording = Recording::open(folder.path(), {.sensor = "os1-64"});
  CHECK(recording.sensor().rows() == 16);
  CHECK(recording.warnings().at(0).find("only rows 3, 7, ... 63 of 64") != std::string::npos);
  CHECK(recording.next()->counts.kept > 16 * 800);
}

TEST_CASE("a named sensor of other beams is refused, one file of another kind is left out") {
  const TemporaryDirectory folder;
  write_numbered(folder, [](int ring) { return ring; });
  CHECK(refused_with([&] { Recording::open(folder.path(), {.sensor = "os1-16"}); }, "os1-16",
                     "vlp-16", "name the sensor"));
  std::string odd = "x y z\n";
  for (int i = 0; i < 3000; ++i) odd += fmt::format("{} {} {}\n", i % 60, i % 7, i % 50 - 10);
  write_file(folder.file("00.txt"), odd);
  auto recording = Recording::open(folder.path());
  CHECK(recording.sensor().name == "vlp-16");
  LeftOut left_out;
  while (next_usable(recording, left_out)) continue;
  CHECK(left_out.scans == 1);
  CHECK(left_out.first.find("00.txt") != std::string::npos);
}

TEST_CASE("a unit whose beams are off the table by a degree is read with its own") {
  const TemporaryDirectory folder;
  const SensorModel sensor = sensor_preset("vlp-16");
  const OpenOptions options = {.sensor = "vlp-16",
                               .files = {.capture = CaptureTime::kMotionCorrected}};
  write_file(folder.file("0.txt"), firing_order(0.0, 360.0, 0.8));
  auto recording = Recording::open(folder.path(), options);
  CHECK(recording.warnings().size() == 1);
  CHECK(recording.sensor() == sensor);  // as it was stated
  CHECK(recording.next()->counts.outside_rows == 0);
  const SensorModel own = inspect(folder.path(), options).sensor;
  for (std::size_t row = 0; row < 16; ++row) {
    CHECK(own.beam_elevation_rad[row] - sensor.beam_elevation_rad[row] ==
          doctest::Approx(radians(0.8)).epsilon(0.001));
  }
  // A sensor that is on its table keeps it, to the last bit.
  write_file(folder.file("0.txt"), firing_order(0.0, 360.0, 0.01));
  CHECK(inspect(folder.path(), options).sensor == sensor);
}

TEST_CASE("a sensor with too few columns for its points is named once") {
  const TemporaryDirectory directory;
  write_scans(directory, 2, [](int) { return firing_order(0.0, 360.0); });  // each half of a degree
  SensorModel sensor = sensor_preset("vlp-16");
  for (const int columns : {1800, 720, 360}) {
    sensor.columns = columns;
    const auto source = open_vlp16(directory, CaptureTime::kRolling, sensor);
    while (source->next()) continue;
    const std::vector<std::string> warnings = source->warnings();
    REQUIRE(std::ssize(warnings) == (columns == 360 ? 1 : 0));
    if (columns == 360) {
      CHECK(warnings[0].find("5760 of 11520 points kept") != std::string::npos);
      CHECK(warnings[0].find("16 x 360") != std::string::npos);
    }
  }
}

TEST_CASE("clouds that are tilted against their sensor keep its beams and cause a warning") {
  const SensorModel sensor = sensor_preset("vlp-16");
  for (const double pitch_deg : {0.0, 3.0}) {
    const TemporaryDirectory directory;
    write_scans(directory, 2, [&](int) { return firing_order(30.0, 270.0, 0.0, pitch_deg); });
    const auto source = open_vlp16(directory);
    while (source->next()) continue;
    CHECK(source->sensor().beam_elevation_rad == sensor.beam_elevation_rad);
    const std::vector<std::string> warnings = source->warnings();
    REQUIRE(std::ssize(warnings) == (pitch_deg > 0.0 ? 1 : 0));
    if (pitch_deg > 0.0) CHECK(one_line_with(warnings[0], "nearer to another beam"));
  }
}

TEST_CASE("a recording whose first scans all are of something else is refused") {
  const TemporaryDirectory directory;
  write_scans(directory, 12, [](int) { return "no scan\n"; });
  CHECK(is_given_up_at_tenth(*open_vlp16(directory)));
}

TEST_CASE("thinned-out clouds get as few columns as they have points, whole ones do not") {
  // Half a degree from firing to firing.
  for (const auto& [columns, read_with] : {std::pair(720, 720), {1440, 1440}, {2160, 720}}) {
    const TemporaryDirectory folder;
    write_scans(folder, 2, [](int) { return firing_order(0.0, 180.0); });
    SensorModel sensor = sensor_preset("vlp-16");
    sensor.columns = columns;
    const auto source = open_vlp16(folder, CaptureTime::kRolling, sensor);
    CHECK(source->sensor().columns == read_with);
    CHECK(source->next()->cloud.columns == read_with);
    CHECK(source->warnings().size() == (columns == read_with ? 0 : 1));
  }
}
