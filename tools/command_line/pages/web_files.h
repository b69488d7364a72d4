#pragma once

#include <functional>
#include <map>
#include <string>

namespace hqslam::tools {

/// The files of tools/web by their names, as they were when the program was built.
const std::map<std::string, std::string, std::less<>>& web_files();

}  // namespace hqslam::tools
