#include "captures.h"
#include "hqslam/core/angles.h"
#include "packets/velodyne_decoder.h"

using namespace hqslam::recordings;

// When and whither every laser fires, and which of two returns is kept: packets made by hand, the
// expectation worked out from the manuals' numbers alone.

namespace {

/// A point as the manuals speak of it.
struct Seen {
  double time_us = 0.0;      ///< after the time of the packet
  double azimuth_deg = 0.0;  ///< clockwise
  double elevation_deg = 0.0;
  float intensity = 0.0F;
};

/// What the decoder makes of one packet, recorded at its time 0: by the range in millimetres.
std::map<int, Seen> decoded(const Payload& packet, VelodyneModel model, bool dual = false,
                            KeptReturn kept = KeptReturn::kStrongest, double cut_deg = 0.0) {
  VelodyneStream stream;
  stream.model = model;
  stream.dual_return = dual;
  stream.cut_azimuth_deg = cut_deg;
  stream.field_of_view_deg = 0.0;  // a packet is a scan
  const SensorModel sensor = sensor_preset(name(model));
  VelodyneDecoder decoder(stream, sensor, {kept, true});
  const std::vector<Scan> scans = test::decoded(decoder, {{0, 2368, packet}});
  REQUIRE(scans.size() == 1);
  std::map<int, Seen> seen;
  for (std::size_t i = 0; i < scans[0].points_m.size(); ++i) {
    const Eigen::Vector3d point_m = scans[0].points_m[i].cast<double>();
    const Seen one{1e6 * (scans[0].stamp_s + double{scans[0].time_offset_s[i]}),
                   degrees(std::atan2(-point_m.y(), point_m.x())),
                   degrees(std::asin(point_m.z() / point_m.norm())), scans[0].intensity[i]};
    CHECK(std::abs(one.elevation_deg - degrees(sensor.beam_elevation_rad[scans[0].row[i]])) < 0.02);
    CHECK(seen.emplace(static_cast<int>(std::lround(1000.0 * point_m.norm())), one).second);
  }
  return seen;
}

/// The same of lasers that measure 5000, 5000 + 10 units, ... mm, 32 a block from this one on.
std::map<int, Seen> decoded_lasers(Payload packet, int block, int lasers, int unit_mm,
                                   VelodyneModel model) {
  for (int laser = 0; laser < lasers; ++laser) {
    set_measurement(packet, block + laser / 32, laser % 32,
                    static_cast<std::uint16_t>(5000 / unit_mm + 10 * laser));
  }
  std::map<int, Seen> seen = decoded(packet, model);
  REQUIRE(static_cast<int>(seen.size()) == lasers);
  return seen;
}

void check_seen(const Seen& seen, double time_us, double azimuth_deg) {
  CHECK(std::abs(seen.time_us - time_us) < 0.002);
  CHECK(std::abs(seen.azimuth_deg - azimuth_deg) < 2e-4);
}

/// Azimuths of twelve blocks: this many share one, then it grows by 0.2 degrees.
Payload packet_of(int first_azimuth, int blocks_alike) {
  std::vector<int> azimuths;
  for (int i = 0; i < 12; ++i) azimuths.push_back(first_azimuth + 20 * (i / blocks_alike));
  return velodyne_packet(0, azimuths, 0);
}

/// A VLS-128's: banks of 32 lasers in turn, from `first_bank` on, each `returns` times.
Payload vls_packet(int first_azimuth, int first_bank, int returns) {
  constexpr std::array<std::uint16_t, 4> kFlags = {0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};
  Payload packet = packet_of(first_azimuth, 12);
  for (int i = 0; i < 12; ++i) {
    const int bank = first_bank + i / returns;
    put(packet, 100 * i, kFlags[bank % 4]);
    put(packet, 100 * i + 2, static_cast<std::uint16_t>(first_azimuth + 20 * (bank / 4)));
  }
  return packet;
}

/// Groups of eight lasers fire 2.665 us apart, with a pause as long after the eighth group.
double vls_laser_us(int laser) {
  const int group = laser / 8;
  return 2.665 * (group < 8 ? group : group + 1);
}

/// Its lasers stand in eight columns; clockwise.
double vls_column_deg(int laser) {
  constexpr std::array<double, 8> kColumns_deg = {6.354,  4.548,  2.732,  0.911,
                                                  -0.911, -2.732, -4.548, -6.354};
  return kColumns_deg[laser % 8];
}

}  // namespace

TEST_CASE("the 32 lasers of an HDL-32E fire one after the other, 1.152 us apart") {
  const auto seen = decoded_lasers(packet_of(9000, 1), 4, 32, 2, VelodyneModel::kHdl32e);
  for (int c = 0; c < 32; ++c) {
    CAPTURE(c);
    const Seen& laser = seen.at(5000 + 20 * c);
    check_seen(laser, 4 * 46.08 + 1.152 * c, 90.0 + 0.2 * (4 + 1.152 * c / 46.08));
    // -30.67, -9.33, -29.33, -8.00, ...
    const double elevation_deg = (c % 2 == 0 ? -30.67 : -9.33) + 4.0 / 3.0 * (c / 2);
    CHECK(std::abs(laser.elevation_deg - elevation_deg) < 0.01);
  }
}

TEST_CASE("the lasers of a VLP-32C fire in pairs, 2.304 us apart, each a step farther round") {
  // Rotational corrections of the manual, clockwise.
  constexpr std::array<double, 32> kOffset_deg = {
      1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4,
      1.4, -4.2, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4};
  const auto seen = decoded_lasers(packet_of(9000, 1), 4, 32, 4, VelodyneModel::kVlp32c);
  for (int c = 0; c < 32; ++c) {
    CAPTURE(c);
    check_seen(seen.at(5000 + 40 * c), 4 * 55.296 + 2.304 * (c / 2),
               90.0 + 0.2 * (4 + 2.304 * c / 55.296) + kOffset_deg[c]);
  }
  CHECK(seen.at(5000).elevation_deg == doctest::Approx(-25.0));
  CHECK(seen.at(5000 + 40 * 3).elevation_deg == doctest::Approx(-15.639));
  CHECK(seen.at(5000 + 40 * 29).elevation_deg == doctest::Approx(15.0));
}

TEST_CASE("the 128 lasers of a VLS-128 fire in 16 groups of eight") {
  // The second of three firings.
  const auto seen = decoded_lasers(vls_packet(9000, 0, 1), 4, 128, 4, VelodyneModel::kVls128);
  for (int laser = 0; laser < 128; ++laser) {
    CAPTURE(laser);
    const double laser_us = vls_laser_us(laser);
    check_seen(seen.at(5000 + 40 * laser), 53.3 + laser_us,
               90.0 + 0.2 * (1 + laser_us / 53.3) + vls_column_deg(laser));
  }
  CHECK(seen.at(5000).elevation_deg == doctest::Approx(-11.742));
  CHECK(seen.at(5000 + 40 * 36).elevation_deg == doctest::Approx(-25.0));
  CHECK(seen.at(5000 + 40 * 59).elevation_deg == doctest::Approx(15.0));
  CHECK(seen.at(5000 + 40 * 127).elevation_deg == doctest::Approx(0.43));
}

TEST_CASE("the time of a VLS-128's packet is that of its first block, whichever bank that is") {
  Payload packet = vls_packet(9000, 2, 1);  // banks 2 3 | 0 1 2 3 | ...
  set_measurement(packet, 0, 0, 1250);      // laser 64
  set_measurement(packet, 1, 9, 1260);      // laser 105
  set_measurement(packet, 2, 0, 1270);      // laser 0 of the next firing
  set_measurement(packet, 3, 30, 1280);     // laser 62
  const auto seen = decoded(packet, VelodyneModel::kVls128);
  REQUIRE(seen.size() == 4);
  // Laser 64 fires 9 * 2.665 us after laser 0, which the azimuth belongs to.
  check_seen(seen.at(5000), 0.0, 90.0 + 0.2 * 23.985 / 53.3 + 6.354);
  check_seen(seen.at(5040), 2.665 * (14 - 9), 90.0 + 0.2 * 2.665 * 14 / 53.3 + 4.548);
  check_seen(seen.at(5080), 53.3 - 23.985, 90.2 + 6.354);
  check_seen(seen.at(5120), 53.3 - 23.985 + 2.665 * 7, 90.2 + 0.2 * 2.665 * 7 / 53.3 - 4.548);
}

TEST_CASE("two returns of a VLS-128: one firing a packet, a pair of blocks for each bank") {
  for (const std::uint8_t filling : {std::uint8_t{0x00}, std::uint8_t{0xFF}}) {
    CAPTURE(filling);
    Payload packet = vls_packet(9000, 0, 2);  // 00 11 22 33, and four blocks that say nothing
    std::fill(packet.begin() + 800, packet.begin() + 1200, filling);
    const auto set_pair = [&](int block, int channel, int last, int last_intensity, int other,
                              int other_intensity) {
      set_measurement(packet, block, channel, static_cast<std::uint16_t>(last),
                      static_cast<std::uint8_t>(last_intensity));
      set_measurement(packet, block + 1, channel, static_cast<std::uint16_t>(other),
                      static_cast<std::uint8_t>(other_intensity));
    };
    set_pair(0, 16, 1700, 50, 1700, 50);  // laser 16: both are the same
    set_pair(2, 5, 1500, 20, 1250, 90);   // laser 37: the strongest is the nearer one
    set_pair(4, 1, 0, 0, 1800, 10);       // laser 65: only one return
    set_pair(6, 31, 1600, 80, 1350, 30);  // laser 127: the last one is the strongest
    const auto strongest = decoded(packet, VelodyneModel::kVls128, true);
    const auto last = decoded(packet, VelodyneModel::kVls128, true, KeptReturn::kLast);
    REQUIRE(strongest.size() == 4);
    REQUIRE(last.size() == 4);
    constexpr double kTurn_deg_per_us = 360.0 / 100'000.0;  // of ten turns a second
    const auto check_laser = [&](int laser, int strongest_mm, int last_mm) {
      const double laser_us = vls_laser_us(laser);
      const double azimuth_deg = 90.0 + kTurn_deg_per_us * laser_us + vls_column_deg(laser);
      check_seen(strongest.at(strongest_mm), laser_us, azimuth_deg);
      check_seen(last.at(last_mm), laser_us, azimuth_deg);
    };
    check_laser(16, 6800, 6800);
    check_laser(37, 5000, 6000);
    check_laser(65, 7200, 7200);
    check_laser(127, 6400, 6400);
  }
}

TEST_CASE("a capture of a VLS-128 with two returns is recognized and has all its points") {
  std::vector<Captured> packets;
  VelodyneProbe probe;
  for (int i = 0; i < 6567; ++i) {  // 0.35 s
    Payload packet = vls_packet(static_cast<int>(std::lround(19.188 * i)) % 36000, 0, 2);
    for (int block = 0; block < 8; ++block) {
      for (int c = 0; c < 32; ++c) set_measurement(packet, block, c, 2500);
    }
    std::fill(packet.begin() + 800, packet.begin() + 1200, std::uint8_t{0});
    put(packet, 1200, static_cast<std::uint32_t>(std::lround(53.3 * i)));
    packets.push_back({std::llround(53'300.0 * i), 2368, std::move(packet)});
    probe.add(as_packet(packets.back()));
  }
  const auto stream = probe.result().value();
  CHECK(stream.model == VelodyneModel::kVls128);
  CHECK(stream.dual_return);
  CHECK(stream.scan_period_s == doctest::Approx(0.1).scale(0).epsilon(0.001));
  VelodyneDecoder decoder(stream, sensor_preset("vls-128"));
  const std::vector<Scan> scans = test::decoded(decoder, packets);
  CHECK(decoder.counts().used == 6567);
  CHECK(decoder.counts().lost + decoder.counts().foreign + decoder.counts().late == 0);
  REQUIRE(scans.size() == 3);
  CHECK(static_cast<double>(scans[1].points_m.size()) / 128.0 ==
        doctest::Approx(100'000 / 53.3).scale(0).epsilon(0.001));
}

TEST_CASE("with two returns a pair of blocks fires as one, and the last pair turns on as before") {
  struct Case {
    VelodyneModel model;
    double block_us, laser_us;  ///< from pair to pair, and from its beginning to channel 6
    double azimuth_us;          ///< what the azimuth has moved on by then
    int unit_mm;
    double offset_deg;
  };
  for (const Case& c : {Case{VelodyneModel::kVlp16, 110.592, 6 * 2.304, 6 * 2.304, 2, 0.0},
                        Case{VelodyneModel::kHdl32e, 46.08, 6 * 1.152, 6 * 1.152, 2, 0.0},
                        Case{VelodyneModel::kVlp32c, 55.296, 3 * 2.304, 6 * 2.304, 4, 4.2}}) {
    CAPTURE(name(c.model));
    Payload packet = packet_of(9000, 2);
    const auto units = [&](int range_mm) {
      return static_cast<std::uint16_t>(range_mm / c.unit_mm);
    };
    set_measurement(packet, 6, 6, units(9000), 5);  // the fourth pair: last and strongest
    set_measurement(packet, 7, 6, units(6000), 9);
    set_measurement(packet, 10, 6, units(8000), 9);  // the sixth: the last one is the strongest
    set_measurement(packet, 11, 6, units(7000), 5);
    set_measurement(packet, 9, 6, units(5000), 5);  // the fifth: only one return
    const double within_deg = 0.2 * c.azimuth_us / c.block_us + c.offset_deg;
    const auto strongest = decoded(packet, c.model, true);
    REQUIRE(strongest.size() == 3);
    check_seen(strongest.at(6000), 3 * c.block_us + c.laser_us, 90.6 + within_deg);
    check_seen(strongest.at(8000), 5 * c.block_us + c.laser_us, 91.0 + within_deg);
    const auto last = decoded(packet, c.model, true, KeptReturn::kLast);
    REQUIRE(last.size() == 3);
    for (const auto& seen : {strongest, last}) {
      check_seen(seen.at(5000), 4 * c.block_us + c.laser_us, 90.8 + within_deg);
    }
    CHECK(strongest.at(6000).intensity == 9.0F);
    CHECK(last.at(9000).intensity == 5.0F);
    check_seen(last.at(9000), 3 * c.block_us + c.laser_us, 90.6 + within_deg);
    check_seen(last.at(8000), 5 * c.block_us + c.laser_us, 91.0 + within_deg);
  }
}

TEST_CASE("the azimuth is interpolated over the front, where 360 degrees become 0") {
  std::vector<int> azimuths;
  for (int i = 0; i < 12; ++i) azimuths.push_back((35950 + 20 * i) % 36000);  // 35990, 10
  Payload packet = velodyne_packet(0, azimuths, 0);
  set_measurement(packet, 2, 16, 2500);      // laser 0 of the second firing: half a block later
  set_measurement(packet, 5, 16 + 3, 5000);  // -15, 1, -13, 3 degrees
  const auto seen = decoded(packet, VelodyneModel::kVlp16, false, KeptReturn::kStrongest, 180.0);
  REQUIRE(seen.size() == 2);
  const double laser_us = 55.296 + 3 * 2.304;
  check_seen(seen.at(10000), 5 * 110.592 + laser_us, 0.5 + 0.2 * laser_us / 110.592);
  CHECK(seen.at(10000).elevation_deg == doctest::Approx(3.0));
  CHECK(std::abs(seen.at(5000).azimuth_deg) < 2e-4);
}
