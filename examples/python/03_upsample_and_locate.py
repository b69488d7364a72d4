"""Locates the scans of a recording as they are and upsampled first, and writes the upsampled ones.

    python 03_upsample_and_locate.py RECORDING
"""

import sys

import numpy as np

import hqslam

scans = list(hqslam.open_recording(sys.argv[1]))
sensor = hqslam.open_recording(sys.argv[1]).sensor
for method in ("", "linear" if sensor.rows == 64 else "", "du-mix"):
    pipeline = hqslam.Pipeline(sensor, method)
    located = [pipeline.process(scan) for scan in scans]
    pipeline.finish()
    end_m = pipeline.trajectory().T_map_sensor[-1][:3, 3]
    print(f"{method or 'as recorded'}: {located[-1].cloud.rows} rows, ends at {np.round(end_m, 3)} m")
np.save("upsampled.npy", np.stack([scan.cloud.range_m for scan in located]))
