#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "byte_reader.h"

namespace hqslam::recordings {

/// The bytes that a chunk of this compression stands for: "" or "none" (as it is), "lz4" (frames),
/// "zstd" or "bz2". Throws Error, with no file's name in it, if they are not exactly `size`, or for
/// another compression.
std::vector<std::uint8_t> decompressed(Bytes chunk, const std::string& compression,
                                       std::uint64_t size);

}  // namespace hqslam::recordings
