#pragma once

#include <optional>
#include <string>

#include "hqslam/pipeline/beam_check.h"
#include "recording/reading.h"
#include "run/slam_run.h"
#include "run/slam_session.h"

namespace hqslam::tools {

/// "beams: along 132 m of path points are 23.4 mm off their surfaces in the mean, 13.2 mm with
/// corrected beams"
std::string beams_text(const BeamsOfRun& beams);

/// Determines whether the beams of a recording have errors, from its first scans as a session
/// processes them.
class BeamCorrection {
 public:
  explicit BeamCorrection(const SlamSession& session) : session_(session) {}

  /// After each scan. Whether the beams have errors, once the path is long enough to determine it.
  bool found_in(const ReadScan& read);
  /// At the end of a recording whose path may be shorter. Whether the beams have errors.
  bool found();
  const std::optional<BeamsOfRun>& corrected() const { return corrected_; }

 private:
  const SlamSession& session_;
  pipeline::BeamCheck check_;
  bool is_done_ = false;
  std::optional<BeamsOfRun> corrected_;
};

}  // namespace hqslam::tools
