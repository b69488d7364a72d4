#pragma once

#include <cstdint>
#include <span>

namespace hqslam::fuzz {

using Bytes = std::span<const std::uint8_t>;

// One reader each, given hostile bytes as the file that it reads. An Error is what they are for;
// any other exception passes through and is a finding.

void npy(Bytes input);
void npz(Bytes input);
void pcd(Bytes input);
void ply(Bytes input);
void kitti_bin(Bytes input);
void text(Bytes input);
/// Whose points say which sensor they are of.
void found_sensor(Bytes input);
void stamps(Bytes input);
void sensor_json(Bytes input);
void tum(Bytes input);
void kitti(Bytes input);
/// Also what is looked for in the map.
void saved_map(Bytes input);
/// A map's .yaml file, and from P5 on its image.
void occupancy_map(Bytes input);

void weights(Bytes input);
void checkpoint(Bytes input);
void recipe_json(Bytes input);

void pcap(Bytes input);
void db3(Bytes input);
void mcap(Bytes input);
void ros1_bag(Bytes input);
void ouster_json(Bytes input);
/// The first byte names the model, whole packets follow.
void velodyne_packets(Bytes input);
/// The first byte names the lasers, 16 or 32, and the return, whole packets follow.
void hesai_packets(Bytes input);
/// A RoboSense's packets: of settings the first one.
void robosense_packets(Bytes input);
/// A Hesai's angle file.
void hesai_angles(Bytes input);
/// The first byte names the profile and the rows; whole packets of them follow.
inline constexpr int kOusterRows = 2;
void ouster_packets(Bytes input);
/// What comes to a port from several hosts: the first byte names the sensor, steps of packets
/// follow.
inline constexpr int kLiveStepBytes = 7;
void live_packets(Bytes input);

}  // namespace hqslam::fuzz
