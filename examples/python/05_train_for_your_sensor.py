"""Trains a network for the sensor of a recording with hqslam-lab, and upsamples a scan with it.

    python 05_train_for_your_sensor.py RECORDING HQSLAM_LAB [STEPS]

A few steps show how it goes; a useful network takes 40,000 and more drives (docs/training.md).
"""

import json
import subprocess
import sys
from pathlib import Path

import hqslam

recording = hqslam.open_recording(sys.argv[1])
hqslam.write_sensor_json(recording.sensor, "mine.json")  # with all rows, of which 16 are measured
drive = {"drive": "town", "scans": 100, "every": 20}
recipe = {
    "network": {"kind": "du-mix", "sensor": json.loads(Path("mine.json").read_text()), "measured_rows": 16},
    "training": [{**drive, "seeds": {"first": 101, "count": 2}}],
    "validation": [{**drive, "seeds": [901]}],
    "steps": int(sys.argv[3]) if len(sys.argv) > 3 else 40000,
    "batch": 2, "learning_rate": 0.002, "largest_gradient_norm": 1.0,
}
Path("recipe.json").write_text(json.dumps(recipe))
subprocess.run([sys.argv[2], "train", "--config", "recipe.json", "--out", "network"], check=True)

upsampler = hqslam.Upsampler("network/weights.npz", recording.sensor)
measured = upsampler.measured(next(iter(recording)).cloud)
print(measured.range_m.shape, "->", upsampler.upsampled_cloud(measured).range_m.shape)
