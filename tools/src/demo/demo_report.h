#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/range_image.h"
#include "report/page.h"
#include "report/turning_view.h"

namespace hqslam::tools {

/// A page that needs no other file but the runs' reports, to which the table's rows lead: the view,
/// the table with its notes, and one scan in every form that SLAM got to see. max_range_m: of the
/// colours.
std::string demo_html(const TurningView& view, const TextTable& table,
                      const std::vector<std::string>& notes,
                      const std::vector<std::pair<std::string, RangeImage>>& images,
                      double max_range_m);

}  // namespace hqslam::tools
