"""Follows a recording, prints where the sensor was, and writes its path.

    python 02_slam_on_a_recording.py drive.pcap
    python 02_slam_on_a_recording.py FOLDER_OF_CLOUDS os1-16 [TRUTH.tum]
"""

import sys

import numpy as np

import hqslam

recording = hqslam.open_recording(sys.argv[1], sensor=sys.argv[2] if len(sys.argv) > 2 else "")
slam = hqslam.Slam(recording.sensor)
for scan in recording:
    slam.add_imu(scan.imu)
    report = slam.process(scan.cloud, scan.stamp_s)
    x_m, y_m, z_m = report.T_map_sensor[:3, 3]
    sigma_m = np.sqrt(np.trace(report.covariance[:3, :3]))
    print(f"{scan.stamp_s:.2f} s  {x_m:.2f} {y_m:.2f} {z_m:.2f} m +- {sigma_m:.2f}  {report.mapping_status}")
slam.finish()  # loops that were still being closed

trajectory = slam.trajectory()
trajectory.write_tum("trajectory.tum")
np.save("map.npy", slam.map_points_m())
print(f"{len(trajectory)} scans, {trajectory.path_length_m:.1f} m: trajectory.tum, map.npy")
if len(sys.argv) > 3:
    truth = hqslam.read_trajectory(sys.argv[3])
    error = hqslam.absolute_pose_error(trajectory, truth)
    print(f"APE {error.translation_statistics.rmse:.3f} m")
