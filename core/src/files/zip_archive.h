#pragma once

#include <zip.h>

#include <cstddef>
#include <memory>

namespace hqslam {

using ZipArchive = std::unique_ptr<zip_t, decltype([](zip_t* archive) { zip_discard(archive); })>;

/// Longest excerpt of an array's name in a message; names of a network's weights are shorter.
inline constexpr std::size_t kNameCharacters = 120;

}  // namespace hqslam
