#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compare/upsampling_comparison.h"
#include "train/recorded_drive.h"
#include "train/right_share.h"

namespace hqslam::tools {

/// Errors of a method between the rows of a recording, where other scans of the same drive are the
/// only reference.
struct OtherScansScore {
  std::string method;
  double right_share = 0.0;    ///< computed pixels that are right, of those that others measured
  double missing_share = 0.0;  ///< left empty
  Gain over_linear;            ///< of right_share
};

/// In: methods for the drive's sensor, linear interpolation among them; what the drive is called in
/// messages. Throws Error for a drive with too few scans of which others measured something.
std::vector<OtherScansScore> compared_with_other_scans(std::vector<ComparedMethod> methods,
                                                       const RecordedDrive& drive,
                                                       const std::string& source);

std::string scores_text(const std::vector<OtherScansScore>& scores);
nlohmann::ordered_json scores_json(const std::vector<OtherScansScore>& scores);

}  // namespace hqslam::tools
