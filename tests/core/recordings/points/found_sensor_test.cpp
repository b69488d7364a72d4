#include "core/real_data.h"
#include "hqslam/recordings/recording.h"
#include "points/sensor_finder.h"
#include "testing.h"

using namespace hqslam::recordings;

TEST_CASE("the beams that packets tell are found within 0.1 degrees in their points alone") {
  for (const std::string name :
       {"packets/velodyne/hdl-32e_driving_18rev.pcap", "packets/velodyne/vlp-16_dual_return.db3",
        "packets/velodyne/vlp-32c.db3", "ouster/OS-1-64_1024x10_fw20.pcap",
        "ouster/OS-1-32-G_v2.1.1_1024x10.pcap", "handheld_os0"}) {
    CAPTURE(name);
    const auto path = real_data(name);
    if (!path) return;
    for (const bool by_columns : {false, true}) {
      auto source = Recording::open(*path);
      std::vector<RawPoints> scans;
      while (scans.size() < 5) {
        const auto scan = source.next();
        if (!scan) break;
        const OrganizedCloud& cloud = scan->cloud;
        scans.push_back(RawPoints{Scan{}});
        for (int i = 0; i < (by_columns ? cloud.columns : cloud.rows); ++i) {
          for (int j = 0; j < (by_columns ? cloud.rows : cloud.columns); ++j) {
            const std::size_t pixel = by_columns ? cloud.index(j, i) : cloud.index(i, j);
            if (cloud.range_m[pixel] <= 0.0F) continue;
            scans.back().scan.points_m.push_back(cloud.points_m[pixel]);
          }
        }
      }
      const FoundSensor found = find_sensor(scans, std::nullopt, name);
      const std::vector<double>& table_rad = source.sensor().beam_elevation_rad;
      double most_deg = 0.0;
      for (const double beam_rad : found.beam_elevation_rad) {
        double off_rad = std::numbers::pi;
        for (const double row_rad : table_rad) {
          off_rad = std::min(off_rad, std::abs(row_rad - beam_rad));
        }
        most_deg = std::max(most_deg, off_rad * 180.0 / std::numbers::pi);
      }
      MESSAGE(name, ": ", found.beam_elevation_rad.size(), " of ", table_rad.size(),
              " beams, off by at most ", most_deg, " degrees; ", found.note);
      CHECK(most_deg < 0.1);
    }
  }
}
