#pragma once

#include <vector>

#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// The numbers of the selected rows of an image or a sensor with `rows` rows; at least one. Throws
/// Error unless the first one is there and the stride is positive.
std::vector<int> selected_rows(int rows, RowSelection selection);

}  // namespace hqslam
