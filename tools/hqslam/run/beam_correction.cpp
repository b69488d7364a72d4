#include "run/beam_correction.h"

#include <fmt/format.h>

namespace hqslam::tools {

std::string beams_text(const BeamsOfRun& beams) {
  return fmt::format(
      "beams: along {:.0f} m of path points are {:.1f} mm off their surfaces in the mean, {:.1f} "
      "mm with corrected beams",
      beams.path_m, 1e3 * beams.residual_before_m, 1e3 * beams.residual_after_m);
}

bool BeamCorrection::found_in(const ReadScan& read) {
  if (is_done_) return corrected_.has_value();
  const slam::ScanReport& report = session_.report();
  check_.add(read.scan.cloud, report, session_.pipeline());
  return check_.is_complete() && found();
}

bool BeamCorrection::found() {
  if (is_done_) return corrected_.has_value();
  is_done_ = true;
  if (!(check_.path_m() >= pipeline::kLeastPathOfErrors_m)) return false;
  const pipeline::Pipeline& pipeline = session_.pipeline();
  const pipeline::Upsampler& upsampler = pipeline.upsampler();
  const slam::BeamCalibration found =
      slam::calibrate_beams(upsampler.measured_sensor(), check_.scans(pipeline.trajectory()));
  if (!pipeline::has_errors(found)) return false;
  corrected_ = {pipeline::corrected(upsampler.recorded(), upsampler.selected_rows(), found),
                check_.path_m(), found.residual_before_m, found.residual_after_m};
  return true;
}

}  // namespace hqslam::tools
