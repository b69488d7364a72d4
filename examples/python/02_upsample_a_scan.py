"""Upsamples the first scan of a recording of 64 beams from 16 of them, and compares it with all.

    python 02_upsample_a_scan.py RECORDING
"""

import sys

import numpy as np

import hqslam

recording = hqslam.open_recording(sys.argv[1])
upsampler = hqslam.Upsampler("du-mix", recording.sensor, measured_rows=16)
recorded = next(iter(recording)).cloud
measured_m = upsampler.measured(recorded).range_m

upsampled = upsampler.run(measured_m)  # (16, 1024) in, (64, 1024) out; metres, 0 is no return
assert upsampled.confidence is not None  # linear interpolation has none
truth_m = recorded.range_m
both = (upsampled.range_m > 0) & (truth_m > 0)
error_m = np.abs(upsampled.range_m - truth_m)
print(f"{measured_m.shape} -> {upsampled.range_m.shape}, median error {np.median(error_m[both]):.3f} m")
for least in (0.1, 0.5, 0.9):
    sure = both & (upsampled.confidence >= least)
    print(f"confidence {least} and more: {sure.sum()} returns, mean error {error_m[sure].mean():.3f} m")
