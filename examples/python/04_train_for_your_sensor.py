"""Trains a network for a sensor of one's own on simulated drives, and upsamples a scan with it.

    python 04_train_for_your_sensor.py [STEPS]

A few steps show how it goes; a useful network takes 40,000 and more drives (docs/training.md).
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

import hqslam

# All rows that the result is to have: 64, of which every fourth one is measured.
elevation_rad = np.radians(np.linspace(15.0, -25.0, 64))
sensor = hqslam.SensorModel("mine", columns=512, beam_elevation_rad=elevation_rad)
hqslam.write_sensor_json(sensor, "mine.json")
drive = {"drive": "town", "scans": 100, "every": 20}
recipe = {
    "network": {"kind": "du-mix", "sensor": json.loads(Path("mine.json").read_text()), "measured_rows": 16},
    "training": [{**drive, "seeds": {"first": 101, "count": 2}}],
    "validation": [{**drive, "seeds": [901]}],
    "steps": int(sys.argv[1]) if len(sys.argv) > 1 else 40000,
    "batch": 2, "learning_rate": 0.002, "largest_gradient_norm": 1.0,
}
Path("recipe.json").write_text(json.dumps(recipe))
subprocess.run([hqslam.program, "train", "--config", "recipe.json", "--out", "network"], check=True)

upsampler = hqslam.Upsampler("network/weights.npz")
scan = next(hqslam.DriveSimulator("block", upsampler.measured_sensor, scans=1))
print(scan.range_m.shape, "->", upsampler.run(scan.range_m).range_m.shape)
