#include "seeds.h"

#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/npz.h"
#include "hqslam/core/trajectory.h"
#include "made_images.h"
#include "readers.h"
#ifdef HQSLAM_FUZZ_RECORDINGS
#include "bags.h"
#endif

namespace hqslam::fuzz {
namespace {

namespace fs = std::filesystem;
fs::path g_folder;

std::string place(const std::string& reader, const std::string& name) {
  fs::create_directories(g_folder / reader);
  return (g_folder / reader / name).string();
}

void put(const std::string& reader, const std::string& name, const std::string& bytes) {
  std::ofstream(place(reader, name), std::ios::binary) << bytes;
}

RangeImage an_image() {
  return test::made_image(16, 32, [](int row, int column) { return 5 + (32 * row + column) % 7; });
}

void put_points() {
  const std::string rows = "5 0 1 3 0\n5 0 0 7 1000\n5 0 -1 11 2000\n5 1 -1 11 3000\n";
  const std::string head =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z ring t\nSIZE 4 4 4 2 4\nTYPE F F F U U\n"
      "COUNT 1 1 1 1 1\nWIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ";
  put("pcd", "ascii", head + "ascii\n" + rows);
  put("pcd", "binary", head + "binary\n" + std::string(72, '\0'));
  std::string packed = {5, 0, 0, 0, 72, 0, 0, 0};
  packed += std::string{0, 0, static_cast<char>(7 << 5), 62, 0, 0, 0, 0};
  put("pcd", "binary_compressed", head + "binary_compressed\n" + packed);
  put("text", "plain", rows);
  put("text", "named", "x,y,z,ring,time\n5,0,1,3,0.01\n5,0,0,7,0.02\n");
  const std::string ply_head =
      " 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar ring\nproperty double time\nend_header\n";
  put("ply", "ascii", "ply\nformat ascii" + ply_head + "5 0 1 3 0.01\n5 0 0 7 0.02\n");
  put("ply", "binary", "ply\nformat binary_little_endian" + ply_head + std::string(42, '\1'));
  Scan scan;
  for (int i = 0; i < 40; ++i) {
    scan.points_m.emplace_back(5.0F, static_cast<float>(20 - i), 0.1F * static_cast<float>(i % 3));
  }
  write_kitti_bin(scan, place("kitti_bin", "scan"));
  scan.row.assign(scan.points_m.size(), 2);
  scan.time_offset_s.assign(scan.points_m.size(), 0.01F);
  scan.intensity.assign(scan.points_m.size(), 9.0F);
  std::string beams = "x,y,z,ring\n";
  std::string points = "x,y,z\n";
  for (int i = 0; i < 4 * 40; ++i) {
    const double azimuth = 0.15 * (i / 4);
    const std::string point =
        fmt::format("{:.3f},{:.3f},{}", 9.0 * std::cos(azimuth), 9.0 * std::sin(azimuth), i % 4);
    beams += fmt::format("{},{}\n", point, i % 4);
    points += point + "\n";
  }
  put("found_sensor", "rings", beams);
  put("found_sensor", "points", points);
  put("stamps", "seconds", "0.1\n0.2\n1316430000.5\n");
  put("stamps", "dates", "2011-09-26 13:02:25.594360375\n2011-09-26 13:02:25.694360375\n");
}

void put_arrays(const std::string& golden_folder) {
  NpyStackWriter(place("npy", "stack"), 16, 32).append(an_image());
  NpzArrays arrays;
  arrays["weights"] = npz_array(std::vector<float>(12, 0.5F), {3, 4});
  arrays["note"] = npz_text("a note");
  write_npz(place("npz", "own"), arrays);
  for (const char* golden : {"numpy_stored.npz", "numpy_deflated.npz"}) {
    put("npz", golden, test::file_contents(golden_folder + "/" + golden));
  }
}

void put_texts() {
  put("occupancy_map", "own",
      "mode: trinary\nresolution: 0.05\norigin: [-1.25, 3.5, 0.0]\nnegate: 0\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
      "P5\n# written by hqslam\n3 2\n255\nabcdef");
  write_sensor_json(sensor_preset("vlp-16"), place("sensor_json", "own"));
  put("sensor_json", "ouster", R"({"beam_intrinsics": {"beam_altitude_angles": [10, 0, -10.5],
    "beam_azimuth_angles": [3, -3, 1]}, "lidar_data_format": {"columns_per_frame": 512},
    "config_params": {"lidar_mode": "512x20"}})");
  Trajectory trajectory;
  for (int i = 0; i < 4; ++i) {
    trajectory.push_back({0.1 * i, pose_from_xyz_rpy({1.0 * i, 2, 3}, 0.1 * i, 0.2, -0.3)});
  }
  write_tum(trajectory, place("tum", "four"));
  write_kitti_poses(trajectory, place("kitti", "four"));
  put("recipe_json", "recipe", R"({
    "network": {"kind": "du-or", "layers": 2, "sensor": "os1-64", "measured_rows": 16,
                "denoiser": {"channels": [8, 8], "memory": 2}},
    "training": [{"drive": "block", "seeds": {"first": 5, "count": 2}, "scans": 4, "every": 2},
                 {"stack": "a.npy", "repeat": 2}],
    "validation": [{"drive": "block", "seeds": [9], "scans": 1, "conditions": "varied"}],
    "steps": 4, "batch": 2, "augmentation": {"crop_columns": 64, "mirror": true},
    "validate_every": 2})");
  // Which array, of what type, how many columns, then its values (replaced_array.h).
  for (const char* reader : {"weights", "checkpoint", "saved_map"}) {
    for (int array = 0; array < 8; ++array) {
      std::string input = {static_cast<char>(array), static_cast<char>(array % 5), 0};
      put(reader, std::to_string(array), input + std::string(64, '\0'));
    }
    put(reader, "text", std::string({0, 4, 0}) + "{\"format\": \"hqslam weights 1\"}");
  }
  // A place and a point farther than any drive leads.
  std::string place(3, '\0');
  for (const double value : {1.0, 0.0, 0.0, 1e10, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0}) {
    place.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  put("saved_map", "far_place", place);
  std::string point = {1, 1, 2};  // an edge, float32, three columns
  for (const float value : {1e10F, 0.0F, 0.0F}) {
    point.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  put("saved_map", "far_point", point);
}

#ifdef HQSLAM_FUZZ_RECORDINGS
/// Packets behind a byte that says of which kind they are.
std::string input_of(int kind, const std::vector<test::Captured>& packets) {
  std::string input(1, static_cast<char>(kind));
  for (const test::Captured& packet : packets) test::append(input, packet.payload);
  return input;
}

/// Seeds of a maker's packets and of captures of them.
void put_packets(const std::string& maker, int number, int kind,
                 const std::vector<test::Captured>& packets) {
  put(maker + "_packets", std::to_string(number), input_of(kind, packets));
  put("pcap", maker + std::to_string(number) + ".pcap", test::pcap_bytes(packets));
}

/// Steps as live_reader.cpp reads them.
void put_live_packets() {
  constexpr int kOwn = 5 * 4;  // what the sensor sends, from host 0
  const auto step = [](int from, int packets, int gap = 0, int clock_gap = 0) {
    std::string bytes;
    for (const int byte : {from, packets - 1, gap, clock_gap, 30 /* 10 turns a second */, 0, 0}) {
      bytes += static_cast<char>(byte);
    }
    return bytes;
  };
  const std::string begins = step(kOwn, 256) + step(kOwn, 200);
  const std::map<std::string, std::string> seeds = {
      {"steady", begins + step(kOwn, 200)},
      {"stranger_first", step(kOwn + 1, 1) + step(kOwn + 2, 100) + begins},
      {"outage", begins + step(kOwn, 100, 2, 2) + step(kOwn, 100, 4, 4)},
      {"restarted", begins + step(kOwn, 200, 2, 7)},
      {"another_address", begins + step(kOwn + 1, 256, 2, 2) + step(kOwn + 1, 256)},
      {"another_mode", begins + step(0, 256) + step(4, 256) + step(kOwn, 100)},
      {"foreign_sizes", step(12, 4) + step(16, 4) + begins + step(16, 4) + step(13, 4)}};
  for (const auto& [name, steps] : seeds) {
    for (char sensor = 0; sensor < 4; ++sensor) {
      put("live_packets", name + std::to_string(sensor), sensor + steps);
    }
  }
}

void put_recordings() {
  const std::vector<test::Captured> velodyne =
      test::velodyne_capture({.duration_s = 0.004, .first_azimuth_deg = 359.0});
  put("pcap", "velodyne.pcap", test::pcap_bytes(velodyne));
  put("pcap", "fragments.pcap", test::pcap_bytes(velodyne, 512));
  put("pcap", "velodyne.pcapng", test::pcapng_bytes(velodyne));
  for (int model = 0; model < 8; ++model) {
    put("velodyne_packets", std::to_string(model), input_of(model, velodyne));
  }
  for (int kind = 0; kind < 4; ++kind) {
    put_packets("hesai", kind, kind,
                test::hesai_capture(kind % 2 == 0 ? 16 : 32, 0.002, kind < 2 ? 0x37 : 0x39));
    const test::Robosense robosense = {kind != 0, kind < 2 ? 16 : 32, kind % 2 == 1};
    put_packets("robosense", kind, robosense.helios ? 1 : 0,
                test::robosense_capture(robosense, 0.004));
  }
  std::string angles = "Channel,Elevation,Azimuth\n";
  for (int i = 0; i < 16; ++i) angles += fmt::format("{},{},0.1\n", i + 1, 15 - 2 * i);
  put("hesai_angles", "xt16", angles);
  for (int profile = 0; profile < 5; ++profile) {
    const recordings::OusterProfile own = test::kOusterProfiles[profile];
    std::vector<test::Captured> packets;
    for (const std::uint32_t frame : {7U, 8U}) {
      const auto turn = test::ouster_turn(own, frame, kOusterRows);
      packets.insert(packets.end(), turn.begin(), turn.begin() + 4);
    }
    put("ouster_packets", std::to_string(profile), input_of(profile, packets));
    std::vector<test::Captured> turn = test::ouster_turn(own, 7);
    turn.resize(3);
    put("ouster_json", std::to_string(profile), test::ouster_metadata_text(own));
    put("pcap", "ouster" + std::to_string(profile) + ".pcap", test::pcap_bytes(turn));
  }
  put_live_packets();
  std::vector<test::CloudPoint> points;
  for (std::uint16_t ring = 0; ring < 16; ++ring) {
    points.push_back({5.0F, 1.0F, 0.1F * ring, ring, 0.001 * ring});
  }
  for (const bool ros1 : {false, true}) {
    constexpr std::int64_t kTime_ns = 1'600'000'000'000'000'000;
    const std::vector<test::BagMessage> messages = {
        {"/points", "sensor_msgs/msg/PointCloud2", kTime_ns,
         test::cloud_message(kTime_ns, points, ros1)},
        {"/text", "std_msgs/msg/String", kTime_ns + 1, test::text_message("a text", ros1)},
        {"/tf_static", "tf2_msgs/msg/TFMessage", kTime_ns + 2,
         test::transform_message("lidar", "imu", Eigen::Quaterniond::Identity(), ros1)},
        {"/imu", "sensor_msgs/msg/Imu", kTime_ns + 3,
         test::imu_message(kTime_ns + 3, "imu", {}, ros1)}};
    if (ros1) {
      for (const char* compression : {"none", "lz4", "bz2"}) {
        put("ros1_bag", compression, test::ros1_bytes(messages, compression));
      }
      continue;
    }
    for (const char* compression : {"", "lz4", "zstd"}) {
      put("mcap", std::string("cloud") + compression, test::mcap_bytes(messages, compression));
    }
    test::write_db3(messages, place("db3", "cloud"));
    const auto packets = test::scan_messages("/packets", "velodyne_msgs/msg/VelodyneScan", velodyne,
                                             velodyne.size(), ros1);
    put("mcap", "packets", test::mcap_bytes(packets, ""));
    test::write_db3(packets, place("db3", "packets"));
  }
}
#endif

}  // namespace

void write_seeds(const std::string& folder, const std::string& golden_folder) {
  g_folder = folder;
  fs::remove_all(g_folder);
  put_points();
  put_arrays(golden_folder);
  put_texts();
#ifdef HQSLAM_FUZZ_RECORDINGS
  put_recordings();
#endif
}

}  // namespace hqslam::fuzz
