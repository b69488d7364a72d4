#include <fmt/ranges.h>

#include "core/recordings/live/loopback.h"
#include "hqslam/core/cloud_file.h"
#include "http_get.h"
#include "tools/program/child.h"
#include "tools/program/untrained_weights.h"
#include "udp_socket.h"

namespace hqslam::test {
namespace {

using namespace std::chrono_literals;

/// A simulated drive as an Ouster would have sent it: packets of the legacy layout.
struct OusterDrive {
  std::string metadata;  ///< of the sensor, as text
  std::vector<Captured> packets;
};

/// folder: written by `hqslam-lab simulate` for an os1-16 or os1-64.
OusterDrive ouster_drive(const std::string& folder) {
  const SensorModel simulated = read_sensor_json(folder + "/sensor.json");
  std::vector<double> altitude_deg;
  std::vector<double> azimuth_deg;
  for (int row = 0; row < simulated.rows(); ++row) {
    altitude_deg.push_back(degrees(simulated.beam_elevation_rad[row]));
    // Clockwise, and from the left edge of a pixel.
    azimuth_deg.push_back(
        -degrees(simulated.beam_azimuth_offset_rad[row] - simulated.column_step_rad() / 2.0));
  }
  OusterDrive drive;
  drive.metadata = fmt::format(
      R"({{"beam_altitude_angles": [{}], "beam_azimuth_angles": [{}], "lidar_mode": "{}x10",
 "lidar_origin_to_beam_origin_mm": 0.0, "prod_line": "OS-1-{}"}})",
      fmt::join(altitude_deg, ", "), fmt::join(azimuth_deg, ", "), simulated.columns,
      simulated.rows());
  const auto metadata = recordings::ouster_metadata_from_json(drive.metadata, folder);
  const SensorModel& sensor = metadata.sensor;
  NpyStackReader images(folder + "/scans.npy");
  for (std::int64_t turn = 0; turn < images.images(); ++turn) {
    const RangeImage image = images.read(turn);
    const auto range_mm = [&](int row, int measured) {
      const int column = (measured - sensor.column_shift(row) + image.columns) % image.columns;
      return static_cast<std::uint32_t>(std::lround(1e3F * image.at(row, column)));
    };
    for (Captured& packet : ouster_turn(metadata, static_cast<std::uint32_t>(turn), range_mm)) {
      drive.packets.push_back(std::move(packet));
    }
  }
  return drive;
}

/// What is sent.
const OusterDrive& drive() {
  static const OusterDrive sent = ouster_drive(simulated_drive());
  return sent;
}

/// `hqslam live` beside this program, with its output in files; {0} in its options is their
/// folder.
class LiveProgram {
 public:
  explicit LiveProgram(const std::string& options) : port_(free_udp_port()) {
    write_file(path("sensor.json"), drive().metadata);
    listens(options);
  }
  /// Once more, into the same folder, after it has ended.
  void start(const std::string& options) {
    fs::remove(path("stdout"));
    fs::remove(path("stderr"));
    child_.emplace(
        fmt::format(
            fmt::runtime("live --sensor '{0}/sensor.json' --out '{0}/out' --port {1} " + options),
            folder_.path(), port_),
        fmt::format(">'{}' 2>'{}'", path("stdout"), path("stderr")));
  }
  /// The same, until it waits for packets.
  void listens(const std::string& options) {
    start(options);
    REQUIRE(says("no packet yet"));
  }

  std::uint16_t port() const { return port_; }
  std::string out() const {
    return fs::exists(path("stdout")) ? file_contents(path("stdout")) : "";
  }
  std::string error() const { return file_contents(path("stderr")); }
  std::string path(const std::string& name) const { return folder_.file(name); }

  /// Waits until the output has such a part; whether it came.
  bool says(const std::string& part) const {
    for (int i = 0; i < 2000; ++i) {
      if (holds(out(), part)) return true;
      std::this_thread::sleep_for(10ms);
    }
    return false;
  }
  /// Sends the drive, slower than in real time, so that a busy computer drops none of its scans,
  /// and waits until all of it was located.
  void send_drive() const {
#ifdef __SANITIZE_ADDRESS__
    constexpr double kSpeed = 0.2;
#else
    constexpr double kSpeed = 0.5;
#endif
    replay(drive().packets, port_, kSpeed);
    REQUIRE(says(fmt::format("{} scans  x", kDriveScans)));
  }
  /// Its exit status.
  int end(int signal_number) { return child_->end(signal_number); }
  /// The same, once it has ended by itself.
  int wait() { return child_->wait(); }

 private:
  TemporaryDirectory folder_;
  std::uint16_t port_;
  std::optional<Child> child_;
};

}  // namespace

TEST_CASE("a drive that is sent live gives the trajectory that its capture gives") {
  LiveProgram live("--record '{0}/kept.pcap'");
  live.send_drive();
  CHECK(live.end(SIGINT) == 0);
  CAPTURE(live.out());
  CAPTURE(live.error());
  CHECK(missing(live.out(), {"Ouster packets, LEGACY from 127.0.0.1",
                             fmt::format("0 of {} scans dropped", kDriveScans)}) == "");
  const Trajectory by_wire = read_tum(live.path("out/trajectory.tum"));
  REQUIRE(by_wire.size() == kDriveScans);
  CHECK(read_kitti_poses(live.path("out/trajectory.kitti")).size() == kDriveScans);
  CHECK(read_cloud(live.path("out/map.pcd")).points_m.size() > 1000);
  CHECK(holds(file_contents(live.path("out/report.html")), "hqslam live"));
  const auto timings = json_of(live.path("out/timings.json"));
  CHECK(timings["written_by"] == "hqslam live");
  CHECK(timings["end"] == "complete");
  CHECK(timings["scans_in_recording"] == kDriveScans);
  CHECK(timings["times_ms"]["latency"]["p95"] > timings["times_ms"]["slam_total"]["median"]);
  CHECK(timings["per_scan"]["times_ms"]["latency"].size() == kDriveScans);

  succeeds("run '{}' --out '{}'", live.path("kept.pcap"), live.path("run"));
  const Trajectory by_file = read_tum(live.path("run/trajectory.tum"));
  REQUIRE(by_file.size() == kDriveScans);
  for (std::size_t i = 0; i < by_file.size(); ++i) {
    CHECK(by_wire[i].T_map_sensor.isApprox(by_file[i].T_map_sensor, 1e-9));
    CHECK(by_wire[i].stamp_s == doctest::Approx(by_file[i].stamp_s).epsilon(1e-12));
  }
}

TEST_CASE("live makes the maps that run makes of its capture, and one to be located in again") {
  LiveProgram live("--record '{0}/kept.pcap' --occupancy-grid --save-map");
  const std::string kept = live.path("kept.pcap");
  live.send_drive();
  CHECK(live.end(SIGINT) == 0);
  CAPTURE(live.error());
  succeeds("run '{}' --occupancy-grid --save-map --out '{}'", kept, live.path("run"));
  for (const std::string map : {"map.pgm", "map.yaml", "saved_map.npz"}) {
    CAPTURE(map);
    CHECK(file_contents(live.path("out/" + map)) == file_contents(live.path("run/" + map)));
  }

  live.listens("--map '{0}/run/saved_map.npz'");
  succeeds("replay '{}' --port {}", kept, live.port());
  REQUIRE(live.says(fmt::format("{} scans  x", kDriveScans)));
  CHECK(live.end(SIGINT) == 0);
  const Trajectory again = read_tum(live.path("out/trajectory.tum"));
  const Trajectory first = read_tum(live.path("run/trajectory.tum"));
  REQUIRE(again.size() == first.size());
  const auto end_m = [](const Trajectory& path) -> Eigen::Vector3d {
    return path.back().T_map_sensor.translation();
  };
  CHECK((end_m(again) - end_m(first)).norm() < 0.1);
}

TEST_CASE("killed while recording, live leaves a capture to run on and does not overwrite it") {
  LiveProgram live("--record '{0}/kept.pcap'");
  const std::string kept = live.path("kept.pcap");
  live.send_drive();
  CHECK(live.end(SIGKILL) == -1);

  // At most the last packets, which were not written yet, are missing.
  const std::string recorded = file_contents(kept);
  succeeds("run '{}' --out '{}'", kept, live.path("run"));
  CHECK(read_tum(live.path("run/trajectory.tum")).size() >= kDriveScans - 1);

  live.start("--record '{0}/kept.pcap'");
  CHECK(live.wait() == 2);
  CHECK(missing(live.error(), {kept.substr(0, kept.size() - 5), "name another file"}) == "");
  CHECK(is_one_line(live.error()));
  CHECK(file_contents(kept) == recorded);

  live.listens("--record '{0}/more.pcap'");
  live.send_drive();
  CHECK(live.end(SIGTERM) == 0);
  CHECK(read_tum(live.path("out/trajectory.tum")).size() == kDriveScans);
}

TEST_CASE("results that cannot be written end no drive and no recording; they are written later") {
  for (const bool mended : {true, false}) {
    CAPTURE(mended);
    LiveProgram live("--record '{0}/kept.pcap'");
    fs::create_directory(live.path("out/timings.json"));  // nothing can be renamed to this
    live.send_drive();
    CHECK(live.says("RESULTS NOT WRITTEN"));
    CHECK(holds(live.error(), "the drive continues"));
    if (mended) fs::remove(live.path("out/timings.json"));
    CHECK(live.end(SIGINT) == (mended ? 0 : 2));
    CAPTURE(live.error());
    CHECK(fs::exists(live.path("out/report.html")) == mended);
    succeeds("run '{}' --out '{}'", live.path("kept.pcap"), live.path("run"));
    CHECK(read_tum(live.path("run/trajectory.tum")).size() == kDriveScans);
  }
}

TEST_CASE("metadata that cannot be put beside a recording end the recording, not the drive") {
  LiveProgram live("--record '{0}/kept.pcap'");
  fs::create_directory(live.path("kept.json"));
  live.send_drive();
  REQUIRE(live.says("NOT RECORDED ANY MORE"));
  CHECK(live.end(SIGINT) == 2);
  CHECK(holds(live.error(), "kept.json"));
  CHECK(read_tum(live.path("out/trajectory.tum")).size() == kDriveScans);
}

TEST_CASE("live upsamples scans, serves the page, and ends with SIGTERM as with Ctrl-C") {
  LiveProgram live("--rows 8 --upsample linear --view 0");
  const std::string page = "page: http://127.0.0.1:";
  REQUIRE(live.says(page));
  const int at = std::stoi(live.out().substr(live.out().find(page) + page.size()));
  const auto port = static_cast<std::uint16_t>(at);
  CHECK(holds(live::http_get(kLoopback, port, "/"), "hqslam live"));
  live.send_drive();
  CHECK(nlohmann::json::parse(live::http_get(kLoopback, port, "/state"))["scans"] >= 5);
  const auto view = nlohmann::json::parse(live::http_get(kLoopback, port, "/view"));
  CHECK(view["paths"][0]["pieces"][0].size() >= 3);
  CHECK(view["clouds"][0]["points"].get<std::string>().size() > 5000);
  CHECK(live.end(SIGTERM) == 0);
  CHECK(holds(live.out(), "upsampled to 16 rows by linear"));
  CHECK(read_tum(live.path("out/trajectory.tum")).size() > 5);
}

TEST_CASE("live that never got a packet says so, writes nothing and can be ended") {
  LiveProgram live("--record '{0}/kept.pcap'");
  REQUIRE(live.says(fmt::format("no packet yet on UDP port {}", live.port())));
  CHECK(live.end(SIGINT) == 0);
  CHECK_FALSE(fs::exists(live.path("out")));
  CHECK_FALSE(fs::exists(live.path("kept.pcap")));
}

TEST_CASE("captures are opened by upsample, compare, inspect and table as by run") {
  const TemporaryDirectory folder;
  const OusterDrive drive = ouster_drive(simulated_drive("--sensor os1-64 --scans 6"));
  write_file(folder.file("a.pcap"), pcap_bytes(drive.packets));
  write_file(folder.file("a.json"), drive.metadata);
  const std::string in = folder.path();
  for (const char* arguments :
       {"upsample '{0}/a.pcap' --method linear --return last --out '{0}/upsampled'",
        "compare '{0}/a.pcap' --return last",
        "inspect '{0}/a.pcap' --weights '{1}' --scan 2 --out '{0}/layers.html'",
        "table --drives '{0}/a.pcap' --methods linear,rows-64 --stream 7502 --out '{0}/table'"}) {
    succeeds(fmt::format(fmt::runtime(arguments), in, untrained_file()));
  }
  const nlohmann::json origin = json_of(folder.file("upsampled/upsample.json"));
  CHECK(origin["input"] == in + "/a.pcap");
  CHECK(origin["scans_in_recording"] == 6);
  CHECK(missing(refused("replay '{}/a.pcap' --to nowhere", in),
                {"--to nowhere", "expected an IPv4 or IPv6 address"}) == "");
  CHECK(holds(refused("inspect '{0}/a.pcap' --weights '{1}' --scan 6 --out '{0}/none.html'", in,
                      untrained_file()),
              "has 6 scans"));
}

}  // namespace hqslam::test
