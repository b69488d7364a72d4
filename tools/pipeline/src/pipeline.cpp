#include "hqslam/pipeline/pipeline.h"

#include <chrono>

#include "hqslam/core/projection.h"
#include "hqslam/pipeline/drive_memory.h"
#include "slam_system.h"

namespace hqslam::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

struct Pipeline::Implementation {
  Upsampler upsampler;
  DriveMemory memory{upsampler.method()};
  OwnParts own_parts;
  std::unique_ptr<SlamSystem> slam;
};

Pipeline::Pipeline(const SensorModel& recorded, const PipelineOptions& options)
    : Pipeline(Upsampler(recorded, options.upsampling), options) {}

Pipeline::Pipeline(Upsampler upsampler, const PipelineOptions& options) {
  const auto make_slam = options.slam == SlamKind::kLegoLoam ? lego_loam_system : hqslam_system;
  std::unique_ptr<SlamSystem> slam = make_slam(upsampler.sensor(), options);
  OwnParts own_parts = options.own_parts.value_or(OwnParts(upsampler.measured_sensor()));
  implementation_.reset(new Implementation{.upsampler = std::move(upsampler),
                                           .own_parts = std::move(own_parts),
                                           .slam = std::move(slam)});
}

Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

const Upsampler& Pipeline::upsampler() const { return implementation_->upsampler; }
const OwnParts& Pipeline::own_parts() const { return implementation_->own_parts; }
const SensorModel& Pipeline::sensor() const { return implementation_->upsampler.sensor(); }

void Pipeline::add_imu(const std::vector<ImuSample>& samples) {
  implementation_->slam->add_imu(samples);
}

std::string Pipeline::imu_complaint() const { return implementation_->slam->imu_complaint(); }

LocatedScan Pipeline::process(const RecordedScan& scan, slam::ScanTrace* trace) {
  add_imu(scan.imu);
  return process(scan.cloud, scan.stamp_s, trace);
}

LocatedScan Pipeline::process(const Scan& points, slam::ScanTrace* trace) {
  return process(project(points, upsampler().recorded()).cloud, points.stamp_s, trace);
}

LocatedScan Pipeline::process(const OrganizedCloud& recorded, double stamp_s,
                              slam::ScanTrace* trace) {
  auto& [upsampler, memory, own_parts, slam] = *implementation_;
  LocatedScan located;
  OrganizedCloud measured = own_parts.without(upsampler.measured(recorded));
  if (upsampler.method() == nullptr) {
    located.cloud = std::move(measured);
    located.report = slam->process(located.cloud, stamp_s, trace);
    return located;
  }
  Clock::time_point start = Clock::now();
  located.cloud =
      upsampler.upsampled(measured, memory.recall(measured, slam->trajectory(), stamp_s));
  located.upsampling_s = seconds_since(start);
  located.report = slam->process(located.cloud, stamp_s, trace);
  start = Clock::now();
  memory.insert(measured, slam->trajectory(), slam::is_registered(located.report.mapping_status));
  located.upsampling_s += seconds_since(start);
  return located;
}

std::vector<slam::LoopReport> Pipeline::finish() { return implementation_->slam->finish(); }
const Trajectory& Pipeline::trajectory() const { return implementation_->slam->trajectory(); }
slam::MountingOptions Pipeline::mounting() const { return implementation_->slam->mounting(); }

std::vector<std::size_t> Pipeline::submap_of_scan() const {
  return implementation_->slam->submap_of_scan();
}

const std::vector<std::size_t>& Pipeline::segment_of_scan() const {
  return implementation_->slam->segment_of_scan();
}

std::vector<std::pair<std::size_t, slam::Covariance>> Pipeline::corrected_covariances() const {
  return implementation_->slam->corrected_covariances();
}

std::vector<Eigen::Vector3f> Pipeline::map_points_m(std::optional<std::size_t> submap,
                                                    std::vector<float>* intensity) const {
  return implementation_->slam->map_points_m(submap, intensity);
}

slam::SavedMap Pipeline::saved_map() const { return implementation_->slam->saved_map(); }

}  // namespace hqslam::pipeline
