#pragma once

namespace hqslam::tools {

/// What draws the views of a page, as JavaScript.
extern const char* const kTurningViewScript;

}  // namespace hqslam::tools
