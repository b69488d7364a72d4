#pragma once

#include <optional>
#include <string>

#include "hqslam/pipeline/beam_check.h"
#include "hqslam/pipeline/pipeline.h"
#include "run/slam_run.h"

namespace hqslam::tools {

/// "along 132 m of path points are 23.4 mm off their surfaces (RMS), 13.2 mm with
/// corrected beams"
std::string beams_text(const BeamsOfRun& beams);

/// What the beams of a sensor are calibrated from: nothing else of the pipeline, so that another
/// thread can do it.
struct BeamEvidence {
  SensorModel recorded;
  std::optional<RowSelection> rows;  ///< of it that are used; nothing: all
  SensorModel measured;              ///< with these rows
  std::vector<slam::LocatedScan> scans;
  double path_m = 0.0;
};
/// Nothing where the path is too short.
std::optional<BeamEvidence> evidence_of(const pipeline::BeamCheck& check,
                                        const pipeline::Pipeline& pipeline);
/// The corrections; nothing if the beams have no errors.
std::optional<BeamsOfRun> beams_with_errors(const BeamEvidence& evidence);

}  // namespace hqslam::tools
