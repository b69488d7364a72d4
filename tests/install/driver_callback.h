#include <hqslam/core/projection.h>
#include <hqslam/nn/upsampled_cloud.h>
#include <hqslam/slam/slam.h>

#include <string>
#include <vector>

// A point as a driver hands it over: metres, ring 0 the lowest beam, seconds by the sensor's clock.
struct DriverPoint {
  float x, y, z;
  int ring;
  double time_s;
};

class DriverCallback {
 public:
  explicit DriverCallback(const std::string& weights)
      : upsampler_(load(weights)), slam_(upsampler_.sensor()) {}

  // All points of a turn in, where the sensor was in the middle of it out.
  hqslam::Pose operator()(const std::vector<DriverPoint>& turn, double first_s, double last_s) {
    hqslam::Scan scan;
    scan.stamp_s = (first_s + last_s) / 2;
    for (const DriverPoint& point : turn) {
      scan.points_m.emplace_back(point.x, point.y, point.z);
      scan.row.push_back(static_cast<std::uint16_t>(sensor_.rows() - 1 - point.ring));
      scan.time_offset_s.push_back(static_cast<float>(point.time_s - scan.stamp_s));
    }
    const auto measured = hqslam::project(scan, sensor_).cloud;  // NaN is no return
    const auto lifted = hqslam::nn::upsampled_cloud(upsampler_, measured);
    return slam_.process(lifted, scan.stamp_s).T_map_sensor;
  }

 private:
  static hqslam::nn::Upsampler load(const std::string& weights) {
    auto network = hqslam::nn::SuperResolver::load(weights, {.threads = 2});
    const hqslam::SensorModel sensor = network.sensor();
    return {std::move(network), sensor};
  }

  hqslam::nn::Upsampler upsampler_;
  hqslam::SensorModel sensor_ = select_rows(upsampler_.sensor(), upsampler_.measured_rows());
  hqslam::slam::Slam slam_;
};
