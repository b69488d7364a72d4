"""Shows what happens inside: every tensor of the network, every stage of SLAM, as arrays.

    python 04_look_inside_a_layer.py RECORDING
"""

import sys
from typing import Any

import numpy as np

import hqslam

recording = hqslam.open_recording(sys.argv[1])
weights = hqslam.weights("du-or_os1_16to64")
network = hqslam.SuperResolver(weights)
upsampler = hqslam.Upsampler(weights, recording.sensor)
pipeline = hqslam.Pipeline(recording.sensor, weights)
inside: dict[str, Any] = {}
stages: dict[str, Any] = {}
for scan, _ in zip(recording, range(3)):
    network.run(upsampler.measured(scan.cloud).range_m, trace=inside)
    pipeline.process(scan, trace=stages)

print("DU-OR, by name: channels x rows x columns")
for name, tensor in inside.items():
    print(f"  {name:30} {tensor.shape}")
# What each layer changed: eq. 10's Z is what the prior makes of H.
for k in range(5):
    change_m = np.abs(inside[f"layers.{k}.z"] - inside[f"layers.{k}.h"])
    print(f"layer {k}: mean |Z - H| {change_m.mean():.3f} m")

matched = stages["features.is_matched"]
for kind, name in enumerate(["edges", "posts", "ground", "surfaces"]):
    of_kind = stages["features.kind"] == kind
    print(f"SLAM, {name}: {of_kind.sum()}, of which {(of_kind & matched).sum()} matched in the map")
