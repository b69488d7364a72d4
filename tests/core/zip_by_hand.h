#pragma once

#include <cstdint>
#include <string>
#include <vector>

// Arrays and zip archives put together by hand: also damaged ones, which no library would write.

namespace hqslam::test {

inline std::string little_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>((value >> (8 * i)) & 0xFF);
  return text;
}

/// An .npy file, as numpy's format document describes it.
inline std::string npy_of(const std::string& dictionary, const std::string& data,
                          char version = 1) {
  return std::string("\x93NUMPY") + version + '\0' +
         little_endian(dictionary.size() + 1, version > 1 ? 4 : 2) + dictionary + "\n" + data;
}
inline std::string npy_file(const std::string& dtype, const std::string& shape,
                            const std::string& data, const std::string& fortran_order = "False") {
  return npy_of(
      "{'descr': " + dtype + ", 'fortran_order': " + fortran_order + ", 'shape': " + shape + ", }",
      data);
}

/// The checksum of zip, bit by bit. Source: polynomial 0xEDB88320 of IEEE 802.3, reflected.
inline std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

/// A member put together by hand, of which every field may be false.
struct HandMember {
  std::string name = "a.npy";
  std::string packed;
  std::uint64_t claimed_bytes = 0;
  std::uint32_t crc = 0;
  int method = 0;  // 0 stored, 8 deflated
  int flags = 0;
};

inline HandMember stored(const std::string& contents, const std::string& name = "a.npy") {
  return {name, contents, contents.size(), crc32(contents), 0, 0};
}

/// Source: PKWARE's APPNOTE.TXT, sections 4.3.7, 4.3.12 and 4.3.16.
inline std::string zip_of(const std::vector<HandMember>& members) {
  std::string file;
  std::string directory;
  for (const HandMember& member : members) {
    const std::string common =
        little_endian(20, 2) + little_endian(static_cast<std::uint64_t>(member.flags), 2) +
        little_endian(static_cast<std::uint64_t>(member.method), 2) + little_endian(0x210000, 4) +
        little_endian(member.crc, 4) + little_endian(member.packed.size(), 4) +
        little_endian(member.claimed_bytes, 4) + little_endian(member.name.size(), 2) +
        little_endian(0, 2);
    directory += "PK\x01\x02" + little_endian(20, 2) + common + std::string(10, '\0') +
                 little_endian(file.size(), 4) + member.name;
    file += "PK\x03\x04" + common + member.name + member.packed;
  }
  return file + directory + "PK\x05\x06" + little_endian(0, 4) + little_endian(members.size(), 2) +
         little_endian(members.size(), 2) + little_endian(directory.size(), 4) +
         little_endian(file.size(), 4) + little_endian(0, 2);
}

}  // namespace hqslam::test
