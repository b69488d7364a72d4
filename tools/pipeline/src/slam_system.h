#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "hqslam/pipeline/pipeline.h"

namespace hqslam::pipeline {

/// What the pipeline asks of SLAM, as slam::Slam gives it. Each default is the answer of a system
/// that closes no loops and stays in one submap.
class SlamSystem {
 public:
  virtual ~SlamSystem() = default;
  virtual slam::ScanReport process(const OrganizedCloud& cloud, double stamp_s,
                                   slam::ScanTrace* trace) = 0;
  virtual const Trajectory& trajectory() const = 0;
  virtual const std::vector<std::size_t>& segment_of_scan() const = 0;
  virtual std::vector<Eigen::Vector3f> map_points_m(std::optional<std::size_t> submap,
                                                    std::vector<float>* intensity) const = 0;
  virtual slam::SavedMap saved_map() const = 0;
  virtual std::vector<std::size_t> submap_of_scan() const { return segment_of_scan(); }
  virtual void add_imu(const std::vector<ImuSample>&) {}
  virtual std::string imu_complaint() const { return ""; }
  virtual std::vector<slam::LoopReport> finish() { return {}; }
  virtual slam::MountingOptions mounting() const { return {}; }
  virtual std::vector<std::pair<std::size_t, slam::Covariance>> corrected_covariances() const {
    return {};
  }
};

std::unique_ptr<SlamSystem> hqslam_system(const SensorModel& sensor,
                                          const PipelineOptions& options);
/// Throws Error also where it was built without PCL.
std::unique_ptr<SlamSystem> lego_loam_system(const SensorModel& sensor,
                                             const PipelineOptions& options);

}  // namespace hqslam::pipeline
