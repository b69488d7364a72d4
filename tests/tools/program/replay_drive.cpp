// Sends a drive of `hqslam-lab simulate` to a UDP port of this computer as an Ouster would, in real
// time or SPEED times as fast: what measurements of `hqslam live` are made with; no test by itself.
//   replay_drive FOLDER METADATA.json PORT [SPEED]
// METADATA.json is written first: it goes to `hqslam live --sensor`, which is started within ten
// seconds of it.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include "loopback.h"
#include "tools/program/ouster_drive.h"

int main(int argc, char** argv) {
  using namespace hqslam::test;
  if (argc < 4) {
    std::fprintf(stderr, "replay_drive FOLDER METADATA.json PORT [SPEED]\n");
    return 2;
  }
  const OusterDrive drive = ouster_drive(argv[1]);
  std::ofstream(argv[2]) << drive.metadata;
  std::this_thread::sleep_for(std::chrono::seconds(10));
  replay(drive.packets, static_cast<std::uint16_t>(std::stoi(argv[3])),
         argc > 4 ? std::stod(argv[4]) : 1.0);
}
