#include "points/ring_recovery.h"

#include <Eigen/Geometry>

#include "core/real_data.h"
#include "hqslam/core/kitti_bin.h"
#include "known_scans.h"

using namespace hqslam::recordings;

namespace {

KnownScan only(const KnownScan& known, const auto& keep) {
  KnownScan result;
  for (std::size_t i = 0; i < known.row.size(); ++i) {
    if (keep(known.row[i], known.angle_rad[i])) {
      result.add(known.scan.points_m[i], known.row[i], known.angle_rad[i]);
    }
  }
  return result;
}

/// What is found of a scan, whose rows must all be right.
RingRecovery recovered(const KnownScan& known, const SensorModel& sensor) {
  RingRecovery recovery = recover_rings(known.scan, sensor);
  CHECK(std::ranges::equal(recovery.row, known.row));
  return recovery;
}

KnownScan without_ring(const KnownScan& known, int ring) {
  return only(known, [&](int row, double) { return row != ring; });
}

/// `ring` ends early and the next one begins late, so that the azimuth rises where it should wrap.
KnownScan without_wrap_after(const KnownScan& known, int ring) {
  return only(known, [&](int row, double angle_rad) {
    return !(row == ring && angle_rad > 2.8) && !(row == ring + 1 && angle_rad < 3.4);
  });
}

/// A stray point of the ring's beginning in the middle of it.
KnownScan with_stray_point_in(const KnownScan& known, int ring) {
  KnownScan result;
  bool added = false;
  const auto first = std::ranges::find(known.row, ring) - known.row.begin();
  for (std::size_t i = 0; i < known.row.size(); ++i) {
    if (!added && known.row[i] == ring && known.angle_rad[i] > 3.0) {
      result.add(known.scan.points_m[first], ring, 0.0);
      added = true;
    }
    result.add(known.scan.points_m[i], known.row[i], known.angle_rad[i]);
  }
  return result;
}

/// A point 10 m away.
Eigen::Vector3f level_at(double azimuth_rad) {
  return (10.0 * direction_of(azimuth_rad, 0.0)).cast<float>();
}

std::vector<std::string> real_scans(int every) {
  std::vector<std::string> paths;
  for (const char* drive : {"kitti_drive_0005/velodyne", "kitti_drive_22/velodyne"}) {
    const auto folder = real_data(drive);
    if (!folder) break;
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
      all.push_back(entry.path().string());
    }
    std::ranges::sort(all);
    for (std::size_t i = 0; i < all.size(); i += every) paths.push_back(all[i]);
  }
  return paths;
}

}  // namespace

TEST_CASE("rings are recovered whichever way the sensor turns and wherever rings begin") {
  for (const std::string name : {"hdl-64e", "os1-64", "os1-16", "vlp-16", "hdl-32e"}) {
    for (const double first_azimuth_rad : {0.0, std::numbers::pi}) {
      for (const double direction : {1.0, -1.0}) {
        CAPTURE(name);
        CAPTURE(first_azimuth_rad);
        CAPTURE(direction);
        const SensorModel sensor = sensor_preset(name);
        const KnownScan known = a_square(sensor, {first_azimuth_rad, direction});
        const RingRecovery recovery = recovered(known, sensor);
        CHECK(recovery.spurious_wraps == 0);
        CHECK(recovery.missed_wraps == 0);
        CHECK(recovery.off_table_share < 0.05);
        CHECK(stored_ring_after_ring(known.scan, sensor));
      }
    }
  }
}

TEST_CASE("rings that see next to nothing and empty rings on top are recovered") {
  for (const std::string name : {"hdl-64e", "os1-64", "os1-16", "vlp-16", "hdl-32e", "vls-128"}) {
    CAPTURE(name);
    const SensorModel sensor = sensor_preset(name);
    const KnownScan known = an_open_square(sensor);
    recovered(known, sensor);
    const KnownScan ground = only(known, [&](int row, double) { return row > sensor.rows() / 2; });
    CHECK(recovered(ground, sensor).empty_rings == sensor.rows() / 2 + 1);
  }
}

TEST_CASE("rings beside a near wall, which lasers one above the other see higher, are recovered") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  const KnownScan street = beside_a_wall(sensor);
  for (const int first_ring : {0, 1, 2, 3, 5, 8}) {  // some units' upper rings see nothing
    CAPTURE(first_ring);
    const KnownScan known = only(street, [&](int row, double) { return row >= first_ring; });
    const RingRecovery recovery = recovered(known, sensor);
    CHECK(recovery.spurious_wraps == 0);
    CHECK(recovery.missed_wraps == 0);
    CHECK(recovery.off_table_share < 0.25);  // 0.5 is another sensor
  }
}

TEST_CASE("rings in an alley, of a unit whose beams are off the table, are recovered") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  const RingRecovery recovery = recovered(an_alley(sensor), sensor);
  CHECK(recovery.spurious_wraps == 0);
  CHECK(recovery.off_table_share < 0.5);  // and so the scan is read
}

TEST_CASE("any one empty ring is found, and a stray point that wraps the azimuth begins no ring") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  const KnownScan known = a_square(sensor, {});
  for (int ring = 0; ring < 64; ++ring) {
    CAPTURE(ring);
    CHECK(recovered(without_ring(known, ring), sensor).empty_rings == 1);
    CHECK(recovered(with_stray_point_in(known, ring), sensor).spurious_wraps == 1);
  }
}

TEST_CASE("a wrap that is missing between any two rings is found") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  const KnownScan known = a_square(sensor, {});
  // From ring 1 on: what is left of rings 0 and 1 without the wrap between them does not overlap,
  // so there is nothing to tell their heights apart.
  for (int ring = 1; ring + 1 < 64; ++ring) {
    CAPTURE(ring);
    const RingRecovery recovery = recovered(without_wrap_after(known, ring), sensor);
    CHECK(recovery.missed_wraps == 1);
    CHECK(recovery.empty_rings == 0);
  }
}

TEST_CASE("a spurious wrap, a missing wrap and an empty ring in one scan are all survived") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  const KnownScan damaged =
      with_stray_point_in(without_wrap_after(without_ring(a_square(sensor, {}), 20), 35), 50);
  const RingRecovery recovery = recovered(damaged, sensor);
  CHECK(recovery.spurious_wraps == 1);
  CHECK(recovery.missed_wraps == 1);
  CHECK(recovery.empty_rings == 1);
}

TEST_CASE("a scan of another sensor does not follow the beam table") {
  const Scan scan = a_square(sensor_preset("hdl-64e"), {}).scan;
  for (const std::string name : {"os1-64", "os1-16", "vlp-16", "hdl-32e", "vls-128"}) {
    CAPTURE(name);
    const RingRecovery recovery = recover_rings(scan, sensor_preset(name));
    CHECK((recovery.off_table_share > 0.3 || recovery.spurious_wraps > 10));
  }
}

TEST_CASE("an empty scan and a scan of one point have rings too") {
  const SensorModel sensor = sensor_preset("vlp-16");
  Scan scan;
  CHECK(recover_rings(scan, sensor).empty_rings == 16);
  const double elevation_rad = sensor.beam_elevation_rad[11];
  scan.points_m.emplace_back(10.0F, 0.0F, static_cast<float>(10.0 * std::tan(elevation_rad)));
  const RingRecovery recovery = recover_rings(scan, sensor);
  CHECK(recovery.row.size() == 1);
  CHECK(recovery.empty_rings == 15);
  // A turn with as many gaps as fit into it is one ring.
  scan.points_m.clear();
  for (int i = 0; i < 170; ++i) scan.points_m.push_back(level_at(0.01 + 0.0365 * i));
  CHECK(recover_rings(scan, sensor).empty_rings == 15);
}

TEST_CASE("points stored by columns, at random or to and fro are no rings and are refused") {
  const SensorModel sensor = sensor_preset("os1-64");
  const KnownScan known = a_square(sensor, {});
  std::vector<std::size_t> order(known.row.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return std::tie(known.angle_rad[a], known.row[a]) < std::tie(known.angle_rad[b], known.row[b]);
  });
  Scan columns;
  for (const std::size_t i : order) columns.points_m.push_back(known.scan.points_m[i]);
  CHECK_FALSE(stored_ring_after_ring(columns, sensor));

  Scan shuffled;
  for (std::size_t i = 0; i < order.size(); ++i) {
    shuffled.points_m.push_back(known.scan.points_m[i * 7919 % order.size()]);
  }
  Scan to_and_fro;
  for (int i = 0; i < 20'000; ++i) to_and_fro.points_m.push_back(level_at(i % 2 == 0 ? 1.0 : 1.45));
  for (const Scan* scan : {&shuffled, &to_and_fro}) {
    CHECK(refused_with([&] { recover_rings(*scan, sensor); },
                       "expected points stored ring after ring", "jumps"));
  }
}

TEST_CASE("things 0.9 m away, which lasers beside the axis see ahead of far ones, begin no ring") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  const auto beside_axis_rad = [](double level_m) { return std::atan2(0.13, level_m); };
  KnownScan known = a_square(sensor, {});
  for (std::size_t i = 0; i < known.row.size(); ++i) {
    Eigen::Vector3f& point_m = known.scan.points_m[i];
    const bool near = known.angle_rad[i] > 1.0 && known.angle_rad[i] < 2.5 && i * 7919 % 5 < 2;
    if (near) point_m *= 0.9F / point_m.head<2>().norm();
    const double ahead_rad = beside_axis_rad(point_m.head<2>().norm());
    const Eigen::Rotation2Df turn(static_cast<float>(ahead_rad));
    if (known.angle_rad[i] + ahead_rad < kTwoPi) point_m.head<2>() = turn * point_m.head<2>();
  }
  CHECK(recovered(known, sensor).spurious_wraps == 0);
}

TEST_CASE("the rings of real scans are those that their wraps give") {
  const SensorModel sensor = sensor_preset("hdl-64e");
  for (const std::string& path : real_scans(3)) {
    CAPTURE(path);
    const Scan scan = read_kitti_bin(path);
    KnownScan known;
    int row = 0;
    double previous_rad = 0.0;
    for (const Eigen::Vector3f& p : scan.points_m) {
      const double azimuth_rad = std::atan2(p.y(), p.x());
      const double angle_rad = azimuth_rad < 0.0 ? azimuth_rad + kTwoPi : azimuth_rad;
      if (angle_rad < previous_rad - std::numbers::pi) ++row;
      previous_rad = angle_rad;
      known.add(p, row, angle_rad);
    }
    if (row != 63) continue;                                 // the wraps do not give 64 rings
    CHECK(recovered(known, sensor).off_table_share < 0.25);  // 0.5 is another sensor
  }
}

TEST_CASE("a real scan with one point behind its last ring has a spurious wrap") {
  const auto path = real_data("kitti_drive_0005/velodyne/000042.bin");
  if (!path) return;
  const RingRecovery recovery = recover_rings(read_kitti_bin(*path), sensor_preset("hdl-64e"));
  CHECK(recovery.spurious_wraps == 1);
  CHECK(recovery.empty_rings == 0);
  CHECK(recovery.row.back() == 63);
}
