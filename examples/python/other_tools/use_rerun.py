"""Poses and upsampled scans for rerun: python use_rerun.py RECORDING; then rerun drive.rrd"""

import sys

import rerun as rr

import hqslam

recording = hqslam.open_recording(sys.argv[1])
pipeline = hqslam.Pipeline(recording.sensor, "du-mix")
rr.init("hqslam")
rr.save("drive.rrd")
for scan in recording:
    located = pipeline.process(scan)
    T_map_sensor = located.report.T_map_sensor
    rr.set_time("sensor", duration=scan.stamp_s)
    rr.log("map/sensor", rr.Transform3D(translation=T_map_sensor[:3, 3], mat3x3=T_map_sensor[:3, :3]))
    points_m = located.cloud.points_m[located.cloud.range_m > 0]
    rr.log("map/sensor/scan", rr.Points3D(points_m, radii=0.02))
