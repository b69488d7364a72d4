#include "run/beam_correction.h"

#include <fmt/format.h>

namespace hqslam::tools {

std::string beams_text(const BeamsOfRun& beams) {
  return fmt::format(
      "along {:.0f} m of path points are {:.1f} mm off their surfaces (RMS), {:.1f} "
      "mm with corrected beams",
      beams.path_m, 1e3 * beams.residual_before_m, 1e3 * beams.residual_after_m);
}

std::optional<BeamEvidence> evidence_of(const pipeline::BeamCheck& check,
                                        const pipeline::Pipeline& pipeline) {
  if (!(check.path_m() >= pipeline::kLeastPathOfErrors_m)) return std::nullopt;
  const pipeline::Upsampler& upsampler = pipeline.upsampler();
  return BeamEvidence{upsampler.recorded(), upsampler.selected_rows(), upsampler.measured_sensor(),
                      check.scans(pipeline.trajectory()), check.path_m()};
}

std::optional<BeamsOfRun> beams_with_errors(const BeamEvidence& evidence) {
  const slam::BeamCalibration found = slam::calibrate_beams(evidence.measured, evidence.scans);
  if (!pipeline::has_errors(found)) return std::nullopt;
  return BeamsOfRun{pipeline::corrected(evidence.recorded, evidence.rows, found), evidence.path_m,
                    found.residual_before_m, found.residual_after_m};
}

}  // namespace hqslam::tools
