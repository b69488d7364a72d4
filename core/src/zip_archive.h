#pragma once

#include <zip.h>

#include <cstddef>
#include <memory>

namespace hqslam {

using ZipArchive = std::unique_ptr<zip_t, decltype([](zip_t* archive) { zip_discard(archive); })>;

/// Of an array's name in a message: more than the longest name of a network's weight.
inline constexpr std::size_t kNameCharacters = 120;

}  // namespace hqslam
