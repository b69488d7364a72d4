#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "hqslam/sim/drive.h"
#include "small_sensor.h"

using namespace hqslam;
using namespace hqslam::sim;
using namespace hqslam::test;

namespace {

/// FNV-1a over ranges in whole millimetres, four bytes each, the lowest first.
std::uint64_t hash_of(const RangeImage& image) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const float range_m : image.range_m) {
    auto range_mm = static_cast<std::uint32_t>(std::lround(1000.0 * range_m));
    for (int byte = 0; byte < 4; ++byte) {
      hash = (hash ^ (range_mm & 0xffU)) * 1099511628211ULL;
      range_mm >>= 8U;
    }
  }
  return hash;
}

std::uint64_t hash_of_scan(const DriveSpec& spec, std::int64_t scan) {
  DriveSimulator simulator(spec, small_sensor());
  simulator.skip(scan);
  return hash_of(simulator.next()->image);
}

struct Golden {
  std::string drive;
  std::uint64_t usual;
  std::uint64_t varied;
};

}  // namespace

// Whoever changes these numbers on purpose raises kDriveRevision: what was simulated before is
// stored under it.
TEST_CASE("scan 100 of every drive is what it was when it was first made, on every machine") {
  const std::vector<Golden> drives = {
      {"block", 0x9d41913d7a1be120ULL, 0x55612fbabe1a1b0eULL},
      {"town", 0x80cc264437c523a2ULL, 0xfb93233a27397e00ULL},
      {"hills", 0xd7a25486ad7ab07dULL, 0x72e556a157ab47eeULL},
      {"meadow", 0xe66656b0a35b7093ULL, 0xd00c14427afc5d61ULL},
      {"narrow", 0xa902d5364dfb738dULL, 0x5617f2a7327f47a2ULL},
      {"yard", 0xfe0d0e4cc9db5744ULL, 0x6e1985a181071792ULL},
      {"handheld", 0x6eb0836cd2b79eb0ULL, 0x124fdf2e157abf94ULL},
      {"car-park", 0x1499a0ae7b372b16ULL, 0x1f056e01c7e9393dULL},
      {"indoors", 0xa804437df4e45128ULL, 0x23edec6f10cc456cULL},
  };
  CHECK(drives.size() == drive_preset_names().size());
  for (const Golden& golden : drives) {
    CAPTURE(golden.drive);
    const DriveSpec spec = drive_preset(golden.drive);
    CHECK(hash_of_scan(spec, 100) == golden.usual);
    CHECK(hash_of_scan(with_varied_conditions(spec), 100) == golden.varied);
  }
}
