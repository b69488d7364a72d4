#include "run/slam_session.h"

#include <omp.h>

#include <algorithm>
#include <set>
#include <utility>

namespace hqslam::tools {
namespace {

std::size_t largest_submap(const SlamRun& run) {
  const std::map<std::size_t, std::int64_t> submaps = scans_of_submaps(run);
  const auto largest =
      std::ranges::max_element(submaps, {}, [](const auto& submap) { return submap.second; });
  return largest == submaps.end() ? 0 : largest->first;
}

}  // namespace

SlamSession::SlamSession(pipeline::Upsampler upsampler, const pipeline::PipelineOptions& options,
                         const std::string& input, bool keeps_scans)
    : pipeline_(std::move(upsampler), options),
      uses_imu_(options.slam == pipeline::SlamKind::kHqslam),
      keeps_scans_(keeps_scans) {
  const nn::Upsampler* method = pipeline_.upsampler().method();
  run_.input = input;
  run_.sensor = pipeline_.sensor();
  run_.upsampled_by = method != nullptr ? method->name() : "";
  run_.slam = options.slam_options;
  run_.threads = omp_get_max_threads();
}

ScanRecord& SlamSession::process(const RecordedScan& scan, std::int64_t index, double reading_s,
                                 slam::ScanTrace* trace) {
  if (uses_imu_) run_.imu_samples += scan.imu.size();
  pipeline::LocatedScan located = pipeline_.process(scan, trace);
  cloud_ = std::move(located.cloud);
  ScanRecord record;
  record.scan = index;
  record.report = located.report;
  record.reading_s = reading_s;
  record.upsampling_s = located.upsampling_s;
  record.invalid_points = scan.invalid_points;
  keep(record.report.loop);
  if (keeps_scans_) kept_scans_.offer(run_.scans.size(), cloud_);
  run_.scans.push_back(std::move(record));
  run_.wall_s = seconds_since(start_);
  return run_.scans.back();
}

SlamRun& SlamSession::run_so_far() {
  run_.trajectory = pipeline_.trajectory();
  run_.segment_of_scan = pipeline_.segment_of_scan();
  return run_;
}

std::size_t SlamSession::submaps() const {
  const std::vector<std::size_t> submaps = pipeline_.submap_of_scan();
  return std::set<std::size_t>(submaps.begin(), submaps.end()).size();
}

void SlamSession::keep(const slam::LoopReport& loop) {
  if (loop.status == slam::LoopStatus::kAgrees || loop.status == slam::LoopStatus::kClosed) {
    run_.loops.push_back(loop);
  }
}

SlamRun SlamSession::finished(bool save_map) {
  for (const slam::LoopReport& loop : pipeline_.finish()) keep(loop);
  run_.mounting = pipeline_.mounting();
  run_.imu_complaint = pipeline_.imu_complaint();
  run_.own_parts = pipeline_.own_parts().text();
  run_.submap_of_scan = pipeline_.submap_of_scan();
  run_.wall_s = seconds_since(start_);
  run_so_far();
  for (const auto& [scan, covariance] : pipeline_.corrected_covariances()) {
    run_.scans[scan].report.covariance = covariance;
  }
  run_.largest_submap = largest_submap(run_);
  run_.map_points_m = pipeline_.map_points_m(run_.largest_submap, &run_.map_intensity);
  run_.kept_scans = kept_scans_.take();
  if (save_map) run_.saved_map = pipeline_.saved_map();
  return std::move(run_);
}

}  // namespace hqslam::tools
