#include "golden_folder.h"

namespace hqslam {

std::string golden_folder() { return HQSLAM_GOLDEN_DIR; }

}  // namespace hqslam
