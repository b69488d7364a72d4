#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

#include "captures.h"
#include "error_message.h"
#include "file_contents.h"
#include "hqslam/core/angles.h"
#include "hqslam/recordings/recording.h"
#include "temporary_directory.h"
#include "velodyne_decoder.h"

using namespace hqslam;
using namespace hqslam::recordings;
using namespace hqslam::test;

namespace {

std::string laser_xml(int id, double elevation_deg, const std::string& more) {
  return fmt::format(
      "<item class_id=\"9\"><px class_id=\"10\">\n<id_>{}</id_>{}<vertCorrection_>{}"
      "</vertCorrection_><focalDistance_>0</focalDistance_></px></item>\n",
      id, more, elevation_deg);
}

std::string corrections(double rotation_deg, double distance_cm, double up_cm, double left_cm) {
  return fmt::format(
      "<rotCorrection_>{}</rotCorrection_><distCorrection_> {}</distCorrection_>"
      "<vertOffsetCorrection_>{}</vertOffsetCorrection_><horizOffsetCorrection_>{}"
      "</horizOffsetCorrection_>",
      rotation_deg, distance_cm, up_cm, left_cm);
}

/// Laser 5 at 10 degrees and laser 40 at -21; the others fall from 2 by 0.3 degrees.
std::string db_xml() {
  std::string text = "<?xml version=\"1.0\"?>\n<boost_serialization><DB><points_>\n";
  for (int id = 0; id < 64; ++id) {
    if (id == 5) {
      text += laser_xml(id, 10.0, corrections(3.0, 50.0, 20.0, 2.6));
    } else if (id == 40) {
      text += laser_xml(id, -21.0, corrections(-2.0, 120.0, 15.0, -2.6));
    } else {
      text += laser_xml(id, 2.0 - 0.3 * id, corrections(0.0, 0.0, 0.0, 0.0));
    }
  }
  return text + "</points_></DB></boost_serialization>\n";
}

/// Six firings of both banks, so many hundredths of a degree apart; no returns.
Payload empty_packet(std::uint32_t time_us, double azimuth, double step) {
  std::vector<int> azimuths;
  for (int i = 0; i < 12; ++i) {
    azimuths.push_back(static_cast<int>(std::lround(azimuth + (i / 2) * step)) % 36000);
  }
  Payload packet = velodyne_packet(time_us, azimuths, 0);
  for (int i = 1; i < 12; i += 2) {
    put(packet, 100 * static_cast<std::size_t>(i), std::uint16_t{0xDDFF});
  }
  return packet;
}

/// 0.35 s in a round room of 5 m.
std::vector<Captured> capture() {
  constexpr double kStep = 17.28;  // of ten turns a second in 48 us
  std::vector<Captured> packets;
  for (int i = 0; i < 1215; ++i) {
    Payload packet =
        empty_packet(static_cast<std::uint32_t>(288 * i), std::fmod(6 * kStep * i, 36000.0), kStep);
    for (int block = 0; block < 12; ++block) {
      for (int c = 0; c < 32; ++c) set_measurement(packet, block, c, 2500);
    }
    packets.push_back({1'600'000'000'000'000'000 + i * 288'000LL, 2368, std::move(packet)});
  }
  return packets;
}

VelodyneStream stream_with(const VelodyneCalibration& calibration) {
  VelodyneStream stream;
  stream.model = VelodyneModel::kHdl64e;
  stream.calibration = calibration;
  return stream;
}

}  // namespace

TEST_CASE("a point of an HDL-64E is where its own laser saw it, by the formula of the manual") {
  const TemporaryDirectory folder;
  write_file(folder.file("db.xml"), db_xml());
  const VelodyneCalibration calibration = read_velodyne_calibration(folder.file("db.xml"));
  const SensorModel sensor = sensor_of(calibration);
  CHECK(sensor.name == "hdl-64e");
  CHECK(sensor.beam_elevation_rad.front() == doctest::Approx(radians(10.0)));
  CHECK(sensor.beam_elevation_rad.back() == doctest::Approx(radians(-21.0)));
  struct Case {
    int block, channel, row;
    double elevation_deg, rotation_deg, distance_m, up_m, left_m;
  };
  for (const Case& c : {Case{2, 5, 0, 10.0, 3.0, 0.5, 0.2, 0.026},
                        Case{3, 8, 63, -21.0, -2.0, 1.2, 0.15, -0.026}}) {
    Payload packet = empty_packet(1000, 9000.0, 17.28);
    set_measurement(packet, c.block, c.channel, 5000);
    VelodyneStream stream = stream_with(calibration);
    stream.cut_azimuth_deg = 80.0;
    VelodyneDecoder decoder(stream, sensor);
    std::vector<Captured> packets = {{0, 2368, packet}};
    // Round the rest of the turn, so that it counts.
    for (int i = 1; i < 76; ++i) {
      packets.push_back({0, 2368,
                         empty_packet(static_cast<std::uint32_t>(1000 + 1250 * i),
                                      std::fmod(9000.0 + 450.0 * i, 36000.0), 17.28)});
    }
    const std::vector<Scan> scans = decoded(decoder, packets);
    REQUIRE(!scans.empty());
    REQUIRE(scans[0].points_m.size() == 1);
    CHECK(scans[0].row[0] == c.row);
    const double a = radians(90.17 - c.rotation_deg);  // clockwise; the second firing
    const double e = radians(c.elevation_deg);
    const double d = 10.0 + c.distance_m;
    const double plane = d * std::cos(e) - c.up_m * std::sin(e);
    const double right = plane * std::sin(a) - c.left_m * std::cos(a);
    const double forward = plane * std::cos(a) + c.left_m * std::sin(a);
    const Eigen::Vector3f point_m = scans[0].points_m[0];
    CHECK(point_m.x() == doctest::Approx(forward).epsilon(2e-5));
    CHECK(point_m.y() == doctest::Approx(-right).epsilon(2e-5));
    CHECK(point_m.z() == doctest::Approx(d * std::sin(e) + c.up_m * std::cos(e)).epsilon(2e-5));
  }
}

TEST_CASE("a capture of an HDL-64E opens with its db.xml, and without says what it needs") {
  const TemporaryDirectory folder;
  write_file(folder.file("db.xml"), db_xml());
  write_file(folder.file("a.pcap"), pcap_bytes(capture()));
  CHECK(refused_with([&] { inspect(folder.file("a.pcap")); }, "a.pcap", "HDL-64E", "calibration",
                     "db.xml"));
  OpenOptions options;
  options.sensor = "hdl-64e";
  CHECK(refused_with([&] { inspect(folder.file("a.pcap"), options); }, "db.xml"));
  options.sensor = folder.file("db.xml");
  const RecordingInfo info = inspect(folder.file("a.pcap"), options);
  CHECK(info.sensor.rows() == 64);
  CHECK(info.sensor.scan_period_s == doctest::Approx(0.1).epsilon(0.001));
  CHECK(info.packets.used == 1215);
  CHECK(info.packets.lost == 0);
  const auto source = open_recording(folder.file("a.pcap"), options);
  int scans = 0;
  while (const auto scan = source->next()) {
    ++scans;
    CHECK(scan->counts.kept > 60'000);
    CHECK(scan->cloud.range_m[scan->cloud.index(30, 100)] == doctest::Approx(5.0).epsilon(1e-4));
  }
  CHECK(scans == 3);
}

TEST_CASE("two returns of an HDL-64E are refused in one line") {
  VelodyneProbe probe;
  for (int i = 0; i < 10; ++i) {
    Payload packet = empty_packet(static_cast<std::uint32_t>(i), 100.0 * i, 17.28);
    for (std::size_t block = 0; block < 12; ++block) {
      put(packet, 100 * block + 2, static_cast<std::uint16_t>(100 * i + 17 * (block / 4)));
    }
    probe.add(as_packet({i, 2368, packet}));
  }
  CHECK(refused_with([&] { probe.result(); }, "HDL-64E", "one return"));
}

TEST_CASE("what is no whole calibration is refused in one line, whatever is wrong") {
  const TemporaryDirectory folder;
  const auto refused = [&](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at != std::string::npos) text.replace(at, from.size(), to);
    write_file(folder.file("db.xml"), text);
    const std::string message =
        error_message([&] { read_velodyne_calibration(folder.file("db.xml")); });
    CAPTURE(message);
    return one_line_with(message, "db.xml") && message != "no Error";
  };
  CHECK(refused("", "", ""));
  CHECK(refused(db_xml(), "<id_>7</id_>", "<id_>8</id_>"));
  CHECK(refused(db_xml(), "<vertCorrection_>10</vertCorrection_>", ""));
  CHECK(refused(db_xml(), "<vertCorrection_>10<", "<vertCorrection_>nan<"));
  CHECK(refused(db_xml(), "<vertCorrection_>10<", "<vertCorrection_>1e9<"));
  CHECK(refused(db_xml(), "<vertCorrection_>10<", "<vertCorrection_>\x1B[2J<"));
  CHECK(refused(db_xml().substr(0, 4000), "", ""));
  CHECK(refused_with([&] { read_velodyne_calibration(folder.file("none.xml")); }, "none.xml"));
}

TEST_CASE("damaged packets and calibrations of an HDL-64E neither crash nor hang") {
  const TemporaryDirectory folder;
  std::mt19937 random(5);
  const std::string valid = db_xml();
  int read = 0;
  for (int copy = 0; copy < 200; ++copy) {
    std::string text = valid;
    for (int edit = 0; edit < 3; ++edit) {
      text[random() % text.size()] = static_cast<char>(random());
    }
    if (copy % 5 == 0) text.resize(random() % text.size());
    write_file(folder.file("db.xml"), text);
    const std::string message = error_message([&] {
      sensor_of(read_velodyne_calibration(folder.file("db.xml")));
      ++read;
    });
    CHECK(one_line_with(message));
  }
  CHECK(read > 20);
  write_file(folder.file("db.xml"), valid);
  const VelodyneCalibration calibration = read_velodyne_calibration(folder.file("db.xml"));
  VelodyneDecoder decoder(stream_with(calibration), sensor_of(calibration));
  std::vector<Scan> scans;
  for (Captured captured : capture()) {
    for (int edit = 0; edit < 4; ++edit) {
      // Flags of banks that it has not, azimuths, times.
      const std::size_t block = 100 * (random() % 12);
      if (edit == 0) put(captured.payload, block, std::uint16_t{0xCCFF});
      if (edit == 1) put(captured.payload, block + 2, static_cast<std::uint16_t>(random()));
      if (edit == 2) captured.payload[random() % 1206] = static_cast<std::uint8_t>(random());
    }
    decoder.add(as_packet(captured), scans);
  }
  decoder.finish(scans);
  for (const Scan& scan : scans) {
    for (const Eigen::Vector3f& point_m : scan.points_m) CHECK(point_m.allFinite());
  }
}
