#pragma once

#include "hqslam/pipeline/upsampler.h"

namespace hqslam::tools {

using pipeline::installed_weights;

}  // namespace hqslam::tools
