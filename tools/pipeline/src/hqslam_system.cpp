#include "hqslam/slam/slam.h"
#include "slam_system.h"

namespace hqslam::pipeline {
namespace {

slam::Slam slam_for(const SensorModel& sensor, const PipelineOptions& options) {
  if (!options.map) return {sensor, options.slam_options};
  return {sensor, options.slam_options, *options.map, options.T_map_level_start};
}

class HqslamSystem : public SlamSystem {
 public:
  HqslamSystem(const SensorModel& sensor, const PipelineOptions& options)
      : slam_(slam_for(sensor, options)) {}

  slam::ScanReport process(const OrganizedCloud& cloud, double stamp_s,
                           slam::ScanTrace* trace) override {
    return slam_.process(cloud, stamp_s, trace);
  }
  void add_imu(const std::vector<ImuSample>& samples) override { slam_.add_imu(samples); }
  std::string imu_complaint() const override { return slam_.imu_complaint(); }
  std::vector<slam::LoopReport> finish() override { return slam_.finish(); }
  const Trajectory& trajectory() const override { return slam_.trajectory(); }
  slam::MountingOptions mounting() const override { return slam_.mounting(); }
  std::vector<std::size_t> submap_of_scan() const override { return slam_.submap_of_scan(); }
  const std::vector<std::size_t>& segment_of_scan() const override {
    return slam_.segment_of_scan();
  }
  std::vector<std::pair<std::size_t, slam::Covariance>> corrected_covariances() const override {
    return slam_.corrected_covariances();
  }
  std::vector<Eigen::Vector3f> map_points_m(std::optional<std::size_t> submap,
                                            std::vector<float>* intensity) const override {
    return slam_.map_points_m(submap, intensity);
  }
  slam::SavedMap saved_map() const override { return slam_.saved_map(); }

 private:
  slam::Slam slam_;
};

}  // namespace

std::unique_ptr<SlamSystem> hqslam_system(const SensorModel& sensor,
                                          const PipelineOptions& options) {
  return std::make_unique<HqslamSystem>(sensor, options);
}

}  // namespace hqslam::pipeline
