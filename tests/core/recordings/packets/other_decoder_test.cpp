#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include "bags/message_packets.h"
#include "captures.h"
#include "core/real_data.h"
#include "file_contents.h"
#include "packets/hesai_decoder.h"
#include "packets/velodyne_decoder.h"
#include "packets/velodyne_tables.h"
#include "stream_reader.h"

using namespace hqslam;
using namespace hqslam::recordings;
using namespace hqslam::test;

// Clouds of another decoder (nebula) against ours, from the same packets.

namespace {

/// Their code for a pulse with one return, the strongest and the last at once.
constexpr int kBothReturns = 6;

struct TheirPoint {
  Eigen::Vector3f point_m;
  int channel = -1;  ///< 0 the lowest beam
  int return_type = 6;
  double time_us = 0.0;  ///< as the file has it
  float intensity = 0.0F;
};

/// A binary .pcd of known fields.
std::vector<TheirPoint> their_points(const std::string& path, bool all_fields) {
  const std::string file = file_contents(path);
  const std::string marker = "DATA binary\n";
  const std::size_t data = file.find(marker) + marker.size();
  const std::size_t stride = all_fields ? 32 : 12;
  std::vector<TheirPoint> points;
  for (std::size_t at = data; at + stride <= file.size(); at += stride) {
    TheirPoint point;
    std::memcpy(point.point_m.data(), file.data() + at, 12);
    if (all_fields) {  // x y z, intensity, return type, channel, azimuth elevation distance, time
      std::uint16_t channel = 0;
      std::uint32_t time_ns = 0;
      std::memcpy(&channel, file.data() + at + 14, 2);
      std::memcpy(&time_ns, file.data() + at + 28, 4);
      point.channel = channel;
      point.intensity = static_cast<std::uint8_t>(file[at + 12]);
      point.return_type = static_cast<std::uint8_t>(file[at + 13]);
      point.time_us = 1e-3 * time_ns;
    }
    points.push_back(point);
  }
  return points;
}

struct OurPoint {
  Eigen::Vector3f point_m;
  int row = 0;
  double time_s = 0.0;  ///< after the first scan's stamp
  float intensity = 0.0F;
};

/// The points of the scans of a bag from the `first` one on.
std::vector<OurPoint> our_points(const std::string& path, VelodyneModel expected, bool dual,
                                 std::size_t first) {
  const auto for_each_packet = [&](const auto& use) {
    StreamReader reader(path, "");
    REQUIRE(reader.stream().kind == StreamKind::kVelodynePackets);
    MessagePackets packets(reader.stream(), [&] { return reader.next(); });
    while (const auto packet = packets.next()) use(*packet);
    CHECK(reader.file().streams().size() == 1);
  };
  VelodyneProbe probe;
  for_each_packet([&](const Packet& packet) { probe.add(packet); });
  const auto found = probe.result();
  REQUIRE(found);
  CHECK(found->model == expected);
  CHECK(found->dual_return == dual);
  VelodyneStream whole = *found;
  whole.field_of_view_deg = 1.0;  // what the bag cuts off counts too
  VelodyneDecoder decoder(whole, sensor_preset(name(found->model)));
  for_each_packet([&](const Packet& packet) { decoder.add(packet); });
  decoder.finish();
  const std::vector<Scan> scans = decoder.take_scans();
  CHECK(decoder.counts().late + decoder.counts().foreign == 0);
  std::vector<OurPoint> points;
  for (std::size_t s = first; s < scans.size(); ++s) {
    const Scan& scan = scans[s];
    for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
      points.push_back({scan.points_m[i], scan.row[i],
                        scan.stamp_s - scans.front().stamp_s + double{scan.time_offset_s[i]},
                        scan.intensity[i]});
    }
  }
  return points;
}

/// Of one row, sorted by x: the nearest point within `within_m`.
struct Row {
  std::vector<const OurPoint*> points;
  const OurPoint* nearest(const Eigen::Vector3f& query_m, float within_m) const {
    const auto x_of = [](const OurPoint* point) { return point->point_m.x(); };
    auto it = std::ranges::lower_bound(points, query_m.x() - within_m, {}, x_of);
    const OurPoint* best = nullptr;
    float best_m = within_m;
    for (; it != points.end() && (*it)->point_m.x() <= query_m.x() + within_m; ++it) {
      const float distance_m = ((*it)->point_m - query_m).norm();
      if (distance_m > best_m) continue;
      best_m = distance_m;
      best = *it;
    }
    return best;
  }
};

std::vector<Row> rows_of(const std::vector<OurPoint>& points, std::size_t rows) {
  std::vector<Row> result(rows);
  for (const OurPoint& point : points) {
    result[static_cast<std::size_t>(point.row)].points.push_back(&point);
  }
  for (Row& row : result) {
    std::ranges::sort(row.points, {}, [](const OurPoint* point) { return point->point_m.x(); });
  }
  return result;
}

constexpr float kTolerance_m = 0.005F;

}  // namespace

TEST_CASE(
    "points, times and intensities of a real VLP-16 with two returns are those of another "
    "decoder") {
  const auto bag = real_data("packets/velodyne/vlp-16_dual_return.db3");
  if (!bag) return;
  const auto ours = our_points(*bag, VelodyneModel::kVlp16, true, 3);
  const auto rows = rows_of(ours, 16);
  const auto theirs =
      their_points(*real_data("packets/velodyne/vlp-16_dual_return_1673400472138016708.pcd"), true);
  REQUIRE(theirs.size() == 14831);
  // Their times begin anew with each packet, and count both blocks of a pair. The last pair of a
  // packet has the azimuth of its block, uninterpolated: turned on here by the rate of the head.
  constexpr double kBlock_us = 110.592;
  constexpr double kTurn_us = 100'004.0;
  std::int64_t found = 0;
  std::int64_t second_returns = 0;
  double first_packet_us = 0.0;
  std::int64_t in_time = 0;
  std::int64_t as_bright = 0;
  for (const TheirPoint& their : theirs) {
    const double block = std::floor(their.time_us / kBlock_us);
    const double in_pair_us = their.time_us - block * kBlock_us;
    Eigen::Vector3f their_m = their.point_m;
    if (block >= 10.0) {
      const auto angle_rad = static_cast<float>(2.0 * std::numbers::pi * in_pair_us / kTurn_us);
      their_m = Eigen::AngleAxisf(-angle_rad, Eigen::Vector3f::UnitZ()) * their_m;
    }
    const OurPoint* our =
        rows[static_cast<std::size_t>(15 - their.channel)].nearest(their_m, kTolerance_m);
    if (our == nullptr) {
      // They keep both returns of a pulse, we the stronger one: each pulse is counted once below.
      second_returns += their.return_type != kBothReturns ? 1 : 0;
      continue;
    }
    ++found;
    as_bright += our->intensity == their.intensity ? 1 : 0;
    // What is left is the time of a packet: a multiple of the packets' spacing from the first one.
    const double packet_us = 1e6 * our->time_s - std::floor(block / 2.0) * kBlock_us - in_pair_us;
    if (found == 1) first_packet_us = packet_us;
    const double packets = (packet_us - first_packet_us) / (6.0 * kBlock_us);
    const double off_us = 6.0 * kBlock_us * std::abs(packets - std::round(packets));
    in_time += off_us < 10.0 ? 1 : 0;
  }
  MESSAGE(found, " of ", theirs.size(), " found, ", second_returns, " second returns left out, ",
          in_time, " in time, ", as_bright, " as bright");
  CHECK(static_cast<double>(as_bright) >= 0.999 * static_cast<double>(found));
  CHECK(second_returns <= 99 + 89 + 99 + 89);  // 188 pulses with two
  CHECK(static_cast<double>(found) >=
        0.999 * static_cast<double>(static_cast<std::int64_t>(theirs.size()) - second_returns));
  CHECK(static_cast<double>(in_time) >= 0.999 * static_cast<double>(found));
}

TEST_CASE("points of a real VLP-32C are those of another decoder") {
  const auto bag = real_data("packets/velodyne/vlp-32c.db3");
  if (!bag) return;
  const auto ours = our_points(*bag, VelodyneModel::kVlp32c, false, 0);
  const auto rows = rows_of(ours, 32);
  const SensorModel sensor = sensor_preset("vlp-32c");
  const auto theirs =
      their_points(*real_data("packets/velodyne/vlp-32c_1713492677464078412.pcd"), false);
  REQUIRE(theirs.size() == 26216);
  const std::vector<int> row_of_laser = laser_rows(VelodyneModel::kVlp32c);
  std::int64_t found = 0;
  std::int64_t turned_on = 0;
  for (const TheirPoint& their : theirs) {
    const double elevation_rad =
        std::atan2(their.point_m.z(), std::hypot(their.point_m.x(), their.point_m.y()));
    const auto beam = std::ranges::min_element(sensor.beam_elevation_rad, {}, [&](double beam_rad) {
      return std::abs(beam_rad - elevation_rad);
    });
    const auto row = beam - sensor.beam_elevation_rad.begin();
    if (rows[row].nearest(their.point_m, kTolerance_m) != nullptr) {
      ++found;
      continue;
    }
    // The last block of a packet, one in twelve, has its azimuth uninterpolated there.
    const auto laser = std::ranges::find(row_of_laser, row) - row_of_laser.begin();
    const double angle_rad = 2.0 * std::numbers::pi * 2.304 * static_cast<double>(laser) / 99'994.0;
    const Eigen::AngleAxisf on(-static_cast<float>(angle_rad), Eigen::Vector3f::UnitZ());
    turned_on += rows[row].nearest(on * their.point_m, kTolerance_m) != nullptr ? 1 : 0;
  }
  MESSAGE(found, " of ", theirs.size(), " found, ", turned_on, " more in last blocks");
  CHECK(turned_on <= static_cast<std::int64_t>(theirs.size()) / 12);
  CHECK(static_cast<double>(found + turned_on) >= 0.999 * static_cast<double>(theirs.size()));
}

TEST_CASE("points of a real XT16 and a real XT32 are those of another decoder") {
  for (const auto& [name, cloud] : {std::pair("xt16", "xt16_1732848128093928016"),
                                    std::pair("xt32", "xt32_1673400678101968885")}) {
    const char* const sensor_name = name;  // clang 14 captures no structured binding
    CAPTURE(sensor_name);
    const auto bag = real_data(fmt::format("packets/hesai/{}.db3", name));
    if (!bag) return;
    HesaiDecoder decoder(
        read_hesai_angles(*real_data(fmt::format("packets/hesai/{}_angles.csv", name))));
    StreamReader reader(*bag, "");
    REQUIRE(reader.stream().kind == StreamKind::kHesaiPackets);
    MessagePackets packets(reader.stream(), [&] { return reader.next(); });
    while (const auto packet = packets.next()) {
      // They keep both returns, we one: as packets of one return all blocks give points.
      Payload single(packet->payload.begin(), packet->payload.end());
      CHECK(std::exchange(single[single.size() - 18], std::uint8_t{0x37}) == 0x39);
      Packet copy = *packet;
      copy.payload = single;
      decoder.add(copy);
    }
    decoder.finish();
    const std::vector<Scan> scans = decoder.take_scans();
    CHECK(decoder.counts().late + decoder.counts().foreign + decoder.counts().lost == 0);
    std::vector<OurPoint> ours;
    for (const Scan& scan : scans) {
      for (const Eigen::Vector3f& point_m : scan.points_m) ours.push_back({point_m});
    }
    const Row all = rows_of(ours, 1).front();
    std::vector<float> distances_m;
    std::int64_t found = 0;
    const auto theirs = their_points(*real_data(fmt::format("packets/hesai/{}.pcd", cloud)), false);
    for (const TheirPoint& their : theirs) {
      const OurPoint* our = all.nearest(their.point_m, 0.01F);
      distances_m.push_back(our != nullptr ? (our->point_m - their.point_m).norm() : 0.01F);
      found += distances_m.back() <= 0.002F ? 1 : 0;
    }
    std::ranges::sort(distances_m);
    MESSAGE(name, ": ", found, " of ", theirs.size(), " points within 2 mm, median ",
            1e3F * distances_m[distances_m.size() / 2], " mm, largest ", 1e3F * distances_m.back(),
            " mm");
    CHECK(static_cast<double>(found) >= 0.9999 * static_cast<double>(theirs.size()));
  }
}
