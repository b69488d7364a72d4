#include "files/text_file.h"

#include "hqslam/core/whole_file.h"

namespace hqslam::tools {

void write_text_file(const std::string& text, const std::string& path) {
  replace_file(path, [&](const std::string& part) { write_whole_file(part, text); });
}

}  // namespace hqslam::tools
