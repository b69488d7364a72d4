#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace hqslam {

/// No LZF stream grows by more than this: a reference of 3 bytes stands for at most 264.
inline constexpr std::size_t kLzfMaxRatio = 88;

/// The bytes that an LZF stream stands for; nothing if the stream is damaged or does not stand for
/// exactly `size` bytes. Source of the format: liblzf (Marc Lehmann).
std::optional<std::string> lzf_decompressed(std::string_view stream, std::size_t size);

}  // namespace hqslam
