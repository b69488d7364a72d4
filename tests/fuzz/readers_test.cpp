#include "readers.h"

#include "golden_folder.h"
#include "input_file.h"
#include "seeds.h"
#include "testing.h"

// What the fuzzers do, in seconds and without clang: damaged copies of their seeds, the same ones
// in every run.

std::string fuzz::as_whole_file(Bytes input, const char* extension) {
  return as_file(input, extension);
}

namespace {

/// Bytes that mean something to one parser or another.
const std::vector<std::string> kTokens = {
    "\n", " ",     "-",    "0",    "9999999999", "1e308",  "nan",     "inf", "{", "}",
    "[",  "(",     ")",    "'",    "\"",         ",",      ":",       "#",   "x", "\r",
    "-1", "1e999", "null", "true", "DATA ",      "COUNT ", "POINTS ", "F",   "U", "True"};

/// The same bytes with one to four edits.
std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t count) { return count == 0 ? 0 : random() % count; };
  const std::size_t edits = 1 + below(4);
  for (std::size_t edit = 0; edit < edits; ++edit) {
    const std::size_t at = below(bytes.size() + 1);
    const std::size_t length = below(std::min<std::size_t>(bytes.size() - at, 40) + 1);
    switch (below(6)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(random());
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, length);
        break;
      case 4:
        bytes.insert(at, bytes.substr(at, length));
        break;
      default:
        bytes.replace(at, std::min<std::size_t>(length, below(3)), kTokens[below(kTokens.size())]);
    }
  }
  return bytes;
}

using Reader = void (*)(fuzz::Bytes);

struct NamedReader {
  std::string name;
  Reader read;
  int copies = 500;  ///< of a seed
};

const std::vector<NamedReader> kReaders = {
    {"npz", fuzz::npz, 5000},
    {"pcd", fuzz::pcd, 5000},
    {"sensor_json", fuzz::sensor_json, 5000},
    {"tum", fuzz::tum, 5000},
    {"kitti", fuzz::kitti, 5000},
    {"saved_map", fuzz::saved_map},
    {"occupancy_map", fuzz::occupancy_map},
#ifdef HQSLAM_FUZZ_NN
    {"weights", fuzz::weights},
    {"checkpoint", fuzz::checkpoint},
    {"recipe_json", fuzz::recipe_json},
#endif
#ifdef HQSLAM_FUZZ_RECORDINGS
    {"npy", fuzz::npy, 5000},
    {"ply", fuzz::ply, 5000},
    {"kitti_bin", fuzz::kitti_bin, 5000},
    {"text", fuzz::text, 5000},
    {"found_sensor", fuzz::found_sensor},
    {"stamps", fuzz::stamps, 5000},
    {"pcap", fuzz::pcap},
    {"db3", fuzz::db3},
    {"mcap", fuzz::mcap},
    {"ros1_bag", fuzz::ros1_bag},
    {"ouster_json", fuzz::ouster_json},
    {"velodyne_packets", fuzz::velodyne_packets},
    {"hesai_packets", fuzz::hesai_packets},
    {"robosense_packets", fuzz::robosense_packets},
    {"hesai_angles", fuzz::hesai_angles, 5000},
    {"ouster_packets", fuzz::ouster_packets},
    {"live_packets", fuzz::live_packets, 50},
#endif
};

/// The beginning of a file is where its parser works: every second copy is damaged there.
std::string damaged_copy(const std::string& valid, int copy, std::mt19937& random) {
  const std::size_t head = copy % 2 == 0 ? valid.size() : std::min<std::size_t>(valid.size(), 300);
  return damaged(valid.substr(0, head), random) + valid.substr(head);
}

/// Whether it was read; any other exception than Error is a failed check.
bool reads(Reader reader, const std::string& bytes) {
  try {
    reader({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    return true;
  } catch (const Error& error) {
    CHECK(test::one_line_with(error.what()));
  } catch (const std::exception& error) {
    FAIL_CHECK("not an hqslam::Error: " << error.what());
  }
  return false;
}

}  // namespace

TEST_CASE("damaged copies of every reader's seeds are read or refused, nothing else") {
  const test::TemporaryDirectory directory;
  fuzz::write_seeds(directory.file("seeds"), golden_folder());
  int copies = 0;
  int all_read = 0;
  for (const NamedReader& reader : kReaders) {
    CAPTURE(reader.name);
    std::vector<std::filesystem::path> seeds;
    for (const auto& entry :
         std::filesystem::directory_iterator(directory.file("seeds/" + reader.name))) {
      seeds.push_back(entry.path());
    }
    std::ranges::sort(seeds);
    std::mt19937 random(7);
    int read = 0;
    for (const std::filesystem::path& seed : seeds) {
      CAPTURE(seed.filename().string());
      const std::string valid = test::file_contents(seed.string());
      for (int copy = 0; copy < reader.copies; ++copy) {
        CAPTURE(copy);
        read += reads(reader.read, damaged_copy(valid, copy, random)) ? 1 : 0;
      }
      copies += reader.copies;
    }
    CHECK(read > 0);
    all_read += read;
  }
  CHECK(all_read < copies - copies / 20);  // the damage is worth the name
}
