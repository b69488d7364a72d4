#include "files/content_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <vector>

#include "hqslam/core/error.h"

namespace hqslam::tools {

namespace fs = std::filesystem;

void ContentHash::add(std::string_view bytes) {
  constexpr std::uint64_t kPrime = 1099511628211ULL;
  for (const char byte : bytes) hash_ = (hash_ ^ static_cast<std::uint8_t>(byte)) * kPrime;
}

std::string ContentHash::digits() const { return fmt::format("{:016x}", hash_); }

std::string content_hash(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error("{}: cannot be read", path);
  ContentHash hash;
  std::array<char, 65536> buffer{};
  while (stream) {
    stream.read(buffer.data(), buffer.size());
    hash.add({buffer.data(), static_cast<std::size_t>(stream.gcount())});
  }
  return hash.digits();
}

std::string folder_hash(const std::string& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  ContentHash hash;
  for (const fs::path& file : files) {
    hash.add(fs::relative(file, folder).string() + " " + content_hash(file.string()) + "\n");
  }
  return hash.digits();
}

std::string text_hash(std::string_view text) {
  ContentHash hash;
  hash.add(text);
  return hash.digits();
}

}  // namespace hqslam::tools
