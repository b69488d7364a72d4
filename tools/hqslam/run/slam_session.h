#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "hqslam/pipeline/pipeline.h"
#include "run/kept_scans.h"
#include "run/slam_run.h"
#include "timing/timing.h"

namespace hqslam::tools {

/// Scans through the pipeline one by one, and the record of the run.
class SlamSession {
 public:
  /// input: names the recording or the sensor. keeps_scans: for SlamRun::kept_scans.
  SlamSession(pipeline::Upsampler upsampler, const pipeline::PipelineOptions& options,
              const std::string& input, bool keeps_scans = true);

  /// Locates the next scan. index, reading_s: as in ReadScan. trace: filled with what each stage
  /// made of the scan. Returns the run's last record. Throws Error; ScanError for a scan that is to
  /// be left out.
  ScanRecord& process(const RecordedScan& scan, std::int64_t index = 0, double reading_s = 0.0,
                      slam::ScanTrace* trace = nullptr);
  /// The run so far, with its trajectory and its segments.
  SlamRun& run_so_far();
  /// The run so far without its trajectory and its map.
  SlamRun& run() { return run_; }
  /// Of the last scan.
  const slam::ScanReport& report() const { return run_.scans.back().report; }
  const pipeline::Pipeline& pipeline() const { return pipeline_; }
  /// What SLAM took in as the last scan.
  const OrganizedCloud& cloud() const { return cloud_; }
  /// How many submaps the path is in, between which relative poses are unknown.
  std::size_t submaps() const;
  /// The run with its trajectory and map. save_map: with a map for later drives, which needs loop
  /// closing.
  SlamRun finished(bool save_map = false);

 private:
  void keep(const slam::LoopReport& loop);

  pipeline::Pipeline pipeline_;
  SlamRun run_;
  OrganizedCloud cloud_;
  bool uses_imu_;
  bool keeps_scans_;
  KeptScans kept_scans_;
  SteadyClock::time_point start_ = SteadyClock::now();
};

}  // namespace hqslam::tools
