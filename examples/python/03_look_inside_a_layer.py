"""Shows what happens inside: every tensor of the network, every stage of SLAM, as arrays.

    python 03_look_inside_a_layer.py
"""

from typing import Any

import numpy as np

import hqslam

resolver = hqslam.SuperResolver(hqslam.weights("du-or_os1_16to64"))
slam = hqslam.Slam(resolver.sensor)
for scan in hqslam.DriveSimulator("block", resolver.sensor, scans=3):
    inside: dict[str, Any] = {}
    upsampled = resolver.run(scan.range_m, trace=inside)
    stages: dict[str, Any] = {}
    slam.process(hqslam.unproject(upsampled.range_m, resolver.sensor), scan.stamp_s, trace=stages)

print("DU-OR, by name: channels x rows x columns")
for name, tensor in inside.items():
    print(f"  {name:30} {tensor.shape}")
# What each layer changed: eq. 10's Z is what the prior makes of H.
for k in range(5):
    change_m = np.abs(inside[f"layers.{k}.z"] - inside[f"layers.{k}.h"])
    print(f"layer {k}: Z is {change_m.mean():.3f} m from H in the mean")

print("SLAM:", stages["state"])
matched = stages["features.is_matched"]
for kind, name in enumerate(["edges", "posts", "ground", "surfaces"]):
    of_kind = stages["features.kind"] == kind
    print(f"  {name}: {of_kind.sum()}, of which {(of_kind & matched).sum()} were matched with the map")
