"""Locates the scans of a recording, prints the poses, and writes path and map.

    python 01_slam_on_a_recording.py RECORDING [REFERENCE.tum]
"""

import sys

import numpy as np

import hqslam

recording = hqslam.open_recording(sys.argv[1])
pipeline = hqslam.Pipeline(recording.sensor)
for scan in recording:
    report = pipeline.process(scan).report
    x_m, y_m, z_m = report.T_map_sensor[:3, 3]
    sigma_m = np.sqrt(np.trace(report.covariance[:3, :3]))
    print(f"{scan.stamp_s:.2f} s  {x_m:.2f} {y_m:.2f} {z_m:.2f} m +- {sigma_m:.2f}  {report.mapping_status}")
pipeline.finish()  # loops that were still being closed

trajectory = pipeline.trajectory()
trajectory.write_tum("trajectory.tum")
np.save("map.npy", pipeline.map_points_m())
print(f"{len(trajectory)} scans, {trajectory.path_length_m:.1f} m: trajectory.tum, map.npy")
if len(sys.argv) > 2:
    error = hqslam.absolute_pose_error(trajectory, hqslam.read_trajectory(sys.argv[2]))
    print(f"APE {error.translation_statistics.rmse:.3f} m")
