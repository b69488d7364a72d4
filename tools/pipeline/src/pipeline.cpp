#include "hqslam/pipeline/pipeline.h"

#include <chrono>
#include <limits>
#include <variant>

#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "hqslam/pipeline/drive_memory.h"
#include "hqslam/slam/lego_loam_as_published.h"

namespace hqslam::pipeline {
namespace {

using slam::ScanReport;
using LegoLoam = slam::LegoLoamAsPublished;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

using SlamSystem = std::variant<slam::Slam, LegoLoam>;

SlamSystem slam_for(const SensorModel& sensor, const PipelineOptions& options) {
  if (options.slam == SlamKind::kLegoLoam) {
    if (options.map) {
      throw Error(
          "LeGO-LOAM: expected no saved map, which it cannot be located in, found one; leave it "
          "out, or use hqslam's SLAM");
    }
    return LegoLoam(sensor);
  }
  if (options.map) {
    return slam::Slam(sensor, options.slam_options, *options.map, options.T_map_level_start);
  }
  return slam::Slam(sensor, options.slam_options);
}

/// Its covariances are unknown, its statuses are none of it.
ScanReport report_of(LegoLoam& lego_loam, const OrganizedCloud& cloud, double stamp_s) {
  const Clock::time_point start = Clock::now();
  ScanReport report;
  report.stamp_s = stamp_s;
  report.T_map_sensor = lego_loam.process(cloud, stamp_s);
  report.T_odom_sensor = report.T_map_sensor;
  report.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  report.velocity_covariance = report.covariance;
  for (const float range_m : cloud.range_m) report.returns += range_m > 0.0F ? 1 : 0;
  report.times.total_s = seconds_since(start);
  return report;
}

}  // namespace

struct Pipeline::Implementation {
  Upsampler upsampler;
  DriveMemory memory{upsampler.method()};
  SlamSystem system;
  std::vector<std::size_t> only_segment = {};  ///< of LeGO-LOAM: 0 for every scan

  const slam::Slam* slam() const { return std::get_if<slam::Slam>(&system); }
  slam::Slam* slam() { return std::get_if<slam::Slam>(&system); }
};

Pipeline::Pipeline(const SensorModel& recorded, const PipelineOptions& options)
    : Pipeline(Upsampler(recorded, options.upsampling), options) {}

Pipeline::Pipeline(Upsampler upsampler, const PipelineOptions& options) {
  SlamSystem system = slam_for(upsampler.sensor(), options);
  implementation_.reset(
      new Implementation{.upsampler = std::move(upsampler), .system = std::move(system)});
}

Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

const Upsampler& Pipeline::upsampler() const { return implementation_->upsampler; }
const SensorModel& Pipeline::sensor() const { return implementation_->upsampler.sensor(); }

void Pipeline::add_imu(const std::vector<ImuSample>& samples) {
  if (slam::Slam* slam = implementation_->slam()) slam->add_imu(samples);
}

LocatedScan Pipeline::process(const RecordedScan& scan, slam::ScanTrace* trace) {
  add_imu(scan.imu);
  return process(scan.cloud, scan.stamp_s, trace);
}

LocatedScan Pipeline::process(const Scan& points, slam::ScanTrace* trace) {
  return process(project(points, upsampler().recorded()).cloud, points.stamp_s, trace);
}

LocatedScan Pipeline::process(const OrganizedCloud& recorded, double stamp_s,
                              slam::ScanTrace* trace) {
  auto& [upsampler, memory, system, only_segment] = *implementation_;
  LocatedScan located;
  OrganizedCloud measured = upsampler.measured(recorded);
  if (upsampler.method() == nullptr) {
    located.cloud = std::move(measured);
  } else {
    const Clock::time_point start = Clock::now();
    located.cloud = upsampler.upsampled(measured, memory.recall(measured, trajectory(), stamp_s));
    located.upsampling_s = seconds_since(start);
  }
  if (slam::Slam* slam = implementation_->slam()) {
    located.report = slam->process(located.cloud, stamp_s, trace);
  } else {
    located.report = report_of(std::get<LegoLoam>(system), located.cloud, stamp_s);
    only_segment.push_back(0);
  }
  if (upsampler.has_scan_memory()) {
    const Clock::time_point start = Clock::now();
    memory.insert(measured, trajectory(), slam::is_registered(located.report.mapping_status));
    located.upsampling_s += seconds_since(start);
  }
  return located;
}

std::vector<slam::LoopReport> Pipeline::finish() {
  slam::Slam* slam = implementation_->slam();
  return slam != nullptr ? slam->finish() : std::vector<slam::LoopReport>();
}

const Trajectory& Pipeline::trajectory() const {
  return std::visit([](const auto& system) -> const Trajectory& { return system.trajectory(); },
                    implementation_->system);
}

slam::MountingOptions Pipeline::mounting() const {
  const slam::Slam* slam = implementation_->slam();
  return slam != nullptr ? slam->mounting() : slam::MountingOptions();
}

std::vector<std::size_t> Pipeline::submap_of_scan() const {
  const slam::Slam* slam = implementation_->slam();
  return slam != nullptr ? slam->submap_of_scan() : implementation_->only_segment;
}

const std::vector<std::size_t>& Pipeline::segment_of_scan() const {
  const slam::Slam* slam = implementation_->slam();
  return slam != nullptr ? slam->segment_of_scan() : implementation_->only_segment;
}

std::vector<std::pair<std::size_t, slam::Covariance>> Pipeline::corrected_covariances()
    const {
  const slam::Slam* slam = implementation_->slam();
  if (slam == nullptr) return {};
  return slam->corrected_covariances();
}

std::vector<Eigen::Vector3f> Pipeline::map_points_m(std::optional<std::size_t> submap,
                                                    std::vector<float>* intensity) const {
  const slam::Slam* slam = implementation_->slam();
  if (slam != nullptr) return slam->map_points_m(submap, intensity);
  if (intensity != nullptr) intensity->clear();
  return {};
}

slam::SavedMap Pipeline::saved_map() const {
  const slam::Slam* slam = implementation_->slam();
  if (slam != nullptr) return slam->saved_map();
  throw Error(
      "LeGO-LOAM: expected hqslam's SLAM, which recognizes the places of a saved map; save the "
      "map of a run without LeGO-LOAM");
}

}  // namespace hqslam::pipeline
