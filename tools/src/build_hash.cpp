#include "build_hash.h"

#include "drive_sources.h"
#include "result_sources.h"

namespace hqslam::tools {

std::string result_sources_hash() { return HQSLAM_RESULT_SOURCES; }

std::string drive_sources_hash() { return HQSLAM_DRIVE_SOURCES; }

}  // namespace hqslam::tools
