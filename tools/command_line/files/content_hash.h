#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hqslam::tools {

/// FNV-1a, 64 bits, of bytes that come piece by piece.
class ContentHash {
 public:
  void add(std::string_view bytes);
  /// The hash of all that was added: 16 hexadecimal digits.
  std::string digits() const;

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

/// FNV-1a, 64 bits, of a file's bytes as 16 hexadecimal digits, which change if the file
/// changes; no protection against forgery. Throws Error if it cannot be read.
std::string content_hash(const std::string& path);
/// The hash of all files in a folder and below it, their names included.
std::string folder_hash(const std::string& folder);
/// The hash of a text.
std::string text_hash(std::string_view text);

}  // namespace hqslam::tools
