#pragma once

#include <string>
#include <vector>

#include "hqslam/nn/training/checkpoint.h"

namespace hqslam::tools {

/// tools/web/training.html: the loss and the validation's errors over the steps. title: the folder
/// of the training.
std::string training_html(const std::string& title, const std::vector<nn::CurvePoint>& curve);

}  // namespace hqslam::tools
