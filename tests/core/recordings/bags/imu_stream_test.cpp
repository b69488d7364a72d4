#include "bags/imu_stream.h"

#include "bags.h"
#include "near.h"

using namespace hqslam::recordings;

namespace {

constexpr const char* kImuType = "sensor_msgs/msg/Imu";
constexpr const char* kTransformType = "tf2_msgs/msg/TFMessage";

const ImuSample kTurning = {0.0, {0.0, 0.0, 0.5}, {1.0, 2.0, 9.8}};

/// A cloud in the frame "lidar" every 0.1 s, and samples in others every 10 ms, each of which is
/// written 5 ms late.
struct ImuTopic {
  std::string topic;
  std::string frame;
  double first_covariance = 0.0;
};
std::vector<BagMessage> clouds_with_imu(const std::vector<ImuTopic>& topics, bool ros1) {
  const std::vector<CloudPoint> points = round_cloud(0.1);
  std::vector<BagMessage> messages;
  for (std::int64_t i = 0; i < 60; ++i) {
    const std::int64_t stamp_ns = 1'600'000'000'000'000'000 + i * 10'000'000;
    for (const ImuTopic& of : topics) {
      messages.push_back({of.topic, kImuType, stamp_ns + 5'000'000,
                          imu_message(stamp_ns, of.frame, kTurning, ros1, of.first_covariance)});
    }
    if (i % 10 != 9) continue;
    const std::int64_t begin_ns = stamp_ns - 90'000'000;
    messages.push_back({"/robot/points", "sensor_msgs/msg/PointCloud2", begin_ns + 106'000'000,
                        cloud_message(begin_ns, points, ros1)});
  }
  return messages;
}

RecordingInfo info_of(const TemporaryDirectory& folder, const std::vector<ImuTopic>& topics) {
  write_file(folder.file("b.mcap"), mcap_bytes(clouds_with_imu(topics, false), ""));
  return inspect(folder.file("b.mcap"), {.sensor = "vlp-16", .columns = 720});
}

}  // namespace

TEST_CASE("a bag's clouds come with its sensor_msgs/Imu, turned as /tf_static says") {
  const TemporaryDirectory folder;
  const Eigen::Quaterniond left(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond upside_down(0.0, 1.0, 0.0, 0.0);
  for (const bool ros1 : {false, true}) {
    auto messages = clouds_with_imu({{"/robot/imu", "imu"}}, ros1);
    // imu -> base <- mast <- lidar
    messages.insert(
        messages.begin(),
        {{"/tf_static", kTransformType, 1, transform_message("base", "imu", left, ros1)},
         {"/tf_static", kTransformType, 2, transform_message("base", "mast", left, ros1)},
         {"/tf_static", kTransformType, 3,
          transform_message("mast", "/lidar", upside_down, ros1)}});
    const std::string path = folder.file(ros1 ? "a.bag" : "a.mcap");
    write_file(path, ros1 ? ros1_bytes(messages, "none") : mcap_bytes(messages, ""));
    auto source = Recording::open(path, {.sensor = "vlp-16", .columns = 720});
    const auto scans = all_scans(source);
    REQUIRE(scans.size() == 6);
    CHECK(scans[0].imu.size() == 10);
    for (const RecordedScan& scan : scans) {
      REQUIRE(scan.imu.size() >= 9);
      CHECK(std::abs(scan.imu.back().stamp_s - scan.stamp_s - 0.045) < 0.006);
      CHECK(near(scan.imu[0].angular_rate_rad_per_s, {0.0, 0.0, -0.5}));
      CHECK(near(scan.imu[0].specific_force_mps2, {1.0, -2.0, -9.8}));
    }
    CHECK(source.info().imu_stream == "/robot/imu");
    CHECK(source.info().imu.used == 60);
    CHECK(source.info().imu_rate_hz == doctest::Approx(100.0).epsilon(1e-3));
    CHECK(source.warnings().empty());
  }
}

TEST_CASE("of several sensor_msgs/Imu the one of the scans' frame or namespace is read") {
  const TemporaryDirectory folder;
  CHECK(info_of(folder, {{"/camera/imu", "camera"}, {"/robot/imu", "imu"}}).imu_stream ==
        "/robot/imu");
  CHECK(info_of(folder, {{"/imu", "lidar"}, {"/robot/imu", "imu"}}).imu_stream == "/imu");
  CHECK(info_of(folder, {{"/a/raw", "imu"}, {"/a/data", "imu"}}).imu_stream == "/a/raw");
  const RecordingInfo unclear = info_of(folder, {{"/camera/imu", "camera"}, {"/imu", "imu"}});
  CHECK(unclear.imu_stream.empty());
  CHECK(one_line_with(unclear.warnings, "/camera/imu and /imu may be"));
}

TEST_CASE("a sensor_msgs/Imu in an unjoined frame is named with what to do") {
  const TemporaryDirectory folder;
  const RecordingInfo info = info_of(folder, {{"/imu", "imu"}});
  CHECK(info.imu.used == 60);
  CHECK(one_line_with(info.warnings, "'imu', the scans in 'lidar'"));
  CHECK(info_of(folder, {{"/imu", "lidar"}}).warnings.empty());
}

TEST_CASE("frames of Ouster's drivers are joined without /tf_static, which wins") {
  StaticTransforms transforms;
  const Eigen::Vector3d force(1.0, 2.0, 3.0);
  CHECK(near(transforms.R("os_lidar", "os_imu").value() * force, {-1.0, -2.0, 3.0}));
  CHECK(near(transforms.R("os1_sensor", "os1_imu").value() * force, force));
  CHECK_FALSE(transforms.R("os1_lidar", "os_imu"));
  const Payload upside_down =
      transform_message("os_sensor", "os_imu", Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), false);
  transforms.add({.bytes = upside_down});
  CHECK(near(transforms.R("os_lidar", "os_imu").value() * force, {-1.0, 2.0, -3.0}));
}

TEST_CASE("a transform is passed over whose frames have longer names than a stream's may have") {
  const Eigen::Quaterniond none = Eigen::Quaterniond::Identity();
  for (const std::size_t characters : {kNameCharacters, kNameCharacters + 1}) {
    const std::string name(characters, 'f');
    StaticTransforms transforms;
    for (const Payload& message : {transform_message("base", name, none, false),
                                   transform_message(name, "lidar", none, false)}) {
      transforms.add({.bytes = message});
    }
    CHECK(transforms.R("base", "lidar").has_value() == (characters == kNameCharacters));
    CHECK(transforms.R("base", name).has_value() == (characters == kNameCharacters));
  }
}

TEST_CASE("a sensor_msgs/Imu that says it has no angular rates, or is cut off, is left out") {
  const TemporaryDirectory folder;
  CHECK(info_of(folder, {{"/imu", "lidar", -1.0}}).imu.left_out == 60);
  auto messages = clouds_with_imu({{"/imu", "lidar"}}, false);
  messages[4].bytes.resize(messages[4].bytes.size() - 200);
  write_file(folder.file("b.mcap"), mcap_bytes(messages, ""));
  const RecordingInfo info = inspect(folder.file("b.mcap"), {.sensor = "vlp-16", .columns = 720});
  CHECK(info.imu.used == 59);
  CHECK(info.imu.left_out == 1);
  CHECK(info.scans == 6);
}
