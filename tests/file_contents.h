#pragma once

#include <fstream>
#include <iterator>
#include <set>
#include <vector>

#include "temporary_directory.h"

namespace hqslam::test {

inline std::string file_contents(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline void write_file(const std::string& path, const std::string& contents) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(contents.data(), static_cast<std::streamsize>(contents.size()));
}

/// What `read` gives for the path of a file of this name with these contents.
auto from_file(const std::string& name, const std::string& contents, const auto& read) {
  const TemporaryDirectory folder;
  write_file(folder.file(name), contents);
  return read(folder.file(name));
}

/// Numbers as in memory, low byte first.
std::string raw_bytes(auto... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}
inline std::string raw_bytes(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

/// A text with `to` in place of its first `from`; throws if that is not there.
inline std::string replaced_in(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// Of a folder's contents.
inline std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

}  // namespace hqslam::test
