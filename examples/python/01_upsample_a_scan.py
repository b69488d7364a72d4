"""Upsamples a scan of 16 beams to 64, and says how far the result is from a true 64-beam scan.

    python 01_upsample_a_scan.py
"""

import numpy as np

import hqslam

# A scan to try it on, seen with 64 beams by a sensor that drives through a simulated city; of those
# the network is shown 16.
sensor = hqslam.load_sensor("os1-64")
upsampler = hqslam.Upsampler(hqslam.weights("du-mix_os1_16to64"))
truth_m = next(hqslam.DriveSimulator("town", sensor, seed=7, scans=1)).range_m
measured_m = truth_m[upsampler.sensor.measured_rows]

upsampled = upsampler.run(measured_m)  # (16, 1024) in, (64, 1024) out; metres, 0 is no return
assert upsampled.confidence is not None  # linear interpolation has none
both = (upsampled.range_m > 0) & (truth_m > 0)
error_m = np.abs(upsampled.range_m - truth_m)
print(f"{measured_m.shape} -> {upsampled.range_m.shape}, median error {np.median(error_m[both]):.3f} m")
for least in (0.1, 0.5, 0.9):
    sure = both & (upsampled.confidence >= least)
    print(f"confidence {least} and more: {sure.sum()} returns, mean error {error_m[sure].mean():.3f} m")

# The same as points, (64, 1024, 3) in the sensor's frame.
cloud = hqslam.unproject(upsampled.range_m, sensor)
print(cloud.points_m[cloud.range_m > 0].shape[0], "points")
