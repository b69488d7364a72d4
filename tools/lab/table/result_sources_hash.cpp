#include "table/result_sources_hash.h"

#include "result_sources.h"

namespace hqslam::tools {

std::string result_sources_hash() { return HQSLAM_RESULT_SOURCES; }

}  // namespace hqslam::tools
