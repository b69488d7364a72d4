#include <hqslam/core/projection.h>
#include <hqslam/nn/upsampled_cloud.h>
#include <hqslam/slam/slam.h>

// A point as a driver hands it over: metres, ring 0 the lowest beam, seconds by the sensor's clock.
struct DriverPoint {
  float x, y, z;
  int ring;
  double time_s;
};

struct DriverCallback {
  hqslam::nn::Upsampler upsampler;
  hqslam::SensorModel sensor = upsampler.measured_sensor();
  hqslam::slam::Slam slam{upsampler.sensor()};

  // All points of a turn in, where the sensor was in the middle of it out.
  hqslam::Pose operator()(const std::vector<DriverPoint>& turn, double first_s, double last_s) {
    hqslam::Scan scan;
    scan.stamp_s = (first_s + last_s) / 2;
    for (const DriverPoint& point : turn) {
      scan.points_m.emplace_back(point.x, point.y, point.z);  // NaN is no return
      scan.row.push_back(static_cast<std::uint16_t>(sensor.rows() - 1 - point.ring));
      scan.time_offset_s.push_back(static_cast<float>(point.time_s - scan.stamp_s));
    }
    const auto measured = hqslam::project(scan, sensor).cloud;
    const auto upsampled = hqslam::nn::upsampled_cloud(upsampler, measured);
    return slam.process(upsampled, scan.stamp_s).T_map_sensor;
  }
};
