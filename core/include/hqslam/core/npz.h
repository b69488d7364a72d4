#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace hqslam {

/// One array of an .npz file, in C order, little-endian as stored.
struct NpzArray {
  std::string dtype;  ///< numpy's descr: "<f4", "<f8", "<i8", "<i4", "|u1", "|i1", "|b1"
  std::vector<std::int64_t> shape;
  std::vector<std::byte> bytes;

  std::int64_t elements() const;
};
NpzArray npz_array(const std::vector<float>& values, std::vector<std::int64_t> shape);
NpzArray npz_array(const std::vector<double>& values, std::vector<std::int64_t> shape);
NpzArray npz_array(const std::vector<std::int64_t>& values, std::vector<std::int64_t> shape);
/// Text as a one-dimensional "|u1" array of its UTF-8 bytes: bytes(a["name"]).decode() in numpy.
NpzArray npz_text(const std::string& text);

/// The values; throw Error naming `name` if the dtype is another.
std::vector<float> float_values(const NpzArray& array, const std::string& name);
std::vector<double> double_values(const NpzArray& array, const std::string& name);
std::vector<std::int64_t> int64_values(const NpzArray& array, const std::string& name);
std::string text_value(const NpzArray& array, const std::string& name);

/// The arrays of an .npz file by name (without ".npy").
using NpzArrays = std::map<std::string, NpzArray>;

/// Reads an .npz file as numpy.savez and savez_compressed write it: stored and deflated members,
/// zip64, C order. Sizes are checked against `largest_bytes`, the bound on all arrays of the file
/// together, before memory is allocated. Throws Error: which file and member, what was expected,
/// what was found.
NpzArrays read_npz(const std::string& path, std::int64_t largest_bytes = 256LL << 20);

/// Writes a file that numpy.load reads, members deflated and in the order of their names. The same
/// arrays give the same bytes, whenever they are written. An existing file is replaced only once
/// the new one is complete. Throws Error; also without any array, since libzip writes no empty
/// archive.
void write_npz(const std::string& path, const NpzArrays& arrays);

}  // namespace hqslam
