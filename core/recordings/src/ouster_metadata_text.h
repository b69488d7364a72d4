#pragma once

#include <string>

namespace hqslam::recordings {

/// What a file of metadata holds. Throws Error if it is no file or above 16 MiB.
std::string ouster_metadata_text(const std::string& path);

/// Whether a text that load_sensor understands is an Ouster's metadata.
bool is_ouster_metadata(const std::string& text);

}  // namespace hqslam::recordings
