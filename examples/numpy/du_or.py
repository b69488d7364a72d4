"""DU-OR in numpy alone, as nn/hqs/README.md describes it: 16 measured rows become 64.

    python du_or.py WEIGHTS.npz [TENSORS.npz]

TENSORS.npz is what `hqslam inspect SCAN --weights WEIGHTS.npz --npz TENSORS.npz` writes: its
`measured` is upsampled and every image compared with the engine's. Without it the scan is the
self-test that the weights come with.
"""

import json
import sys
from collections import deque

import numpy as np

weights = dict(np.load(sys.argv[1]))
network = json.loads(weights["description"].tobytes().decode())["network"]
tensors = dict(np.load(sys.argv[2])) if len(sys.argv) > 2 else {}
sensor, rows_of = network["sensor"], network["measured_rows"]
elevation_rad = np.radians(sensor["beam_elevation_deg"])
rows, scale_m, gain, groups = len(elevation_rad), network["range_scale_m"], 4, 5
sizes = network["denoiser"]
tile_rows, tile_columns = sizes["tile_rows"], sizes["tile_columns"]


def convolution(x, name, stride=1):
    """Channels x rows x columns; beyond the rows are zeros, beyond a column the other end."""
    weight, bias = weights[name + ".weight"], weights[name + ".bias"]
    k = weight.shape[2] // 2
    x = np.pad(np.pad(x, ((0, 0), (k, k), (0, 0))), ((0, 0), (0, 0), (k, k)), mode="wrap")
    height, width = x.shape[1] - 2 * k, x.shape[2] - 2 * k
    return bias[:, None, None] + sum(
        np.tensordot(weight[:, :, r, c], x[:, r:r + height:stride, c:c + width:stride], 1)
        for r in range(2 * k + 1) for c in range(2 * k + 1))


def transposed_convolution(x, name):
    """2 x 2, stride 2: every pixel becomes four."""
    weight, bias = weights[name + ".weight"], weights[name + ".bias"]
    out = np.empty((weight.shape[1], 2 * x.shape[1], 2 * x.shape[2]), x.dtype)
    for r in range(2):
        for c in range(2):
            out[:, r::2, c::2] = np.tensordot(weight[:, :, r, c].T, x, 1) + bias[:, None, None]
    return out


def tiled(image):
    """Rows x columns -> pixels of a tile, row by row, x rows of tiles x columns of tiles."""
    split = image.reshape(rows // tile_rows, tile_rows, -1, tile_columns)
    return split.transpose(1, 3, 0, 2).reshape(tile_rows * tile_columns, split.shape[0], -1)


def untiled(tiles):
    split = tiles.reshape(tile_rows, tile_columns, tiles.shape[1], -1)
    return split.transpose(2, 0, 3, 1).reshape(rows, -1)


def prior(k, h, above, below, memory):
    """Eq. 10b: Z = G(H), and what the layer hands to the next."""
    name = f"layers.{0 if network['shared_weights'] else k}."
    slope, levels = sizes["negative_slope"], len(sizes["channels"])
    active = lambda x: np.maximum(x, slope * x)
    x, down = np.concatenate([tiled(h), memory]), []
    for level in range(levels):
        x = active(convolution(x, f"{name}encoder.{level}", 1 if level == 0 else 2))
        down.append(x)
    x = active(convolution(x, name + "bottleneck"))
    for level in reversed(range(levels - 1)):
        x = active(transposed_convolution(x, f"{name}decoder.{level}") + down[level])
    out, pixels = convolution(x, name + "head"), tile_rows * tile_columns
    score = [untiled(out[g * pixels:(g + 1) * pixels]) for g in range(groups)]
    w = np.exp(gain * np.array(score[:4]))
    w /= w.sum(0)
    return w[0] * above + w[1] * below + w[2] * h + score[4], out[groups * pixels:]


def outliers(image_m, options):
    """Q: the computed pixels in connected components of fewer than min_pixels (eq. 9)."""
    columns, least = image_m.shape[1], np.radians(options["min_angle_deg"])

    def connected(a, b, alpha):
        near, far = np.minimum(a, b), np.maximum(a, b)
        angle = np.arctan2(near * np.sin(alpha), far - near * np.cos(alpha))
        return (near > 0) & (angle > least)

    right = connected(image_m, np.roll(image_m, -1, 1), 2 * np.pi / sensor["columns"])
    down = connected(image_m[:-1], image_m[1:], np.abs(np.diff(elevation_rad))[:, None])
    seen, rejected = image_m <= 0, np.zeros(image_m.shape, bool)
    for start in zip(*np.nonzero(image_m > 0)):
        if seen[start]:
            continue
        seen[start], component, queue = True, [], deque([start])
        while queue:
            y, x = queue.popleft()
            component.append((y, x))
            links = [(right[y, x], y, (x + 1) % columns), (right[y, x - 1], y, (x - 1) % columns),
                     (y + 1 < rows and down[y, x], y + 1, x), (y > 0 and down[y - 1, x], y - 1, x)]
            for is_linked, *to in links:
                if is_linked and not seen[tuple(to)]:
                    seen[tuple(to)] = True
                    queue.append(tuple(to))
        if len(component) < options["min_pixels"]:
            for y, x in component:
                rejected[y, x] = y not in measured and not supported(image_m, y, x, options)
    return rejected


def supported(image_m, y, x, options):
    """Whether the range is near one that was measured above or below, or beside that."""
    above = rows_of["offset"] + (y - rows_of["offset"]) // rows_of["stride"] * rows_of["stride"]
    return any(abs(image_m[y, x] - m) < options["support_share"] * m
               for row in (above, above + rows_of["stride"]) if 0 <= row < rows
               for m in image_m[row, [x - 1, x, (x + 1) % image_m.shape[1]]])


def check(name, image, unit=1.0):
    if name in tensors:
        worst[name] = np.abs(image * unit - tensors[name][0]).max()


worst = {}
measured_m = tensors["measured"][0] if tensors else weights["self_test.measured"]
measured = list(range(rows_of["offset"], rows, rows_of["stride"]))[:len(measured_m)]
# Between which measured rows each row stands, and how far down; beyond the last ones at them.
place = np.clip((np.arange(rows) - rows_of["offset"]) / rows_of["stride"], 0, len(measured) - 1)
up, low = np.floor(place).astype(int), np.ceil(place).astype(int)
part = (place - up)[:, None]
above, below = measured_m[up] / scale_m, measured_m[low] / scale_m
mean = (1 - part) * above + part * below
z = np.where((above > 0) & (below > 0), mean, np.where(part < 0.5, above, below))
y, l = z, below
memory = np.zeros((sizes["memory"], rows // tile_rows, z.shape[1] // tile_columns))
check("start", z, scale_m)
for k in range(network["layers"]):
    b = network["penalty"] if "penalty" in network else np.exp(np.resize(weights["log_penalty"], k + 1)[k])
    h = (z + y) / 2
    h[measured] = ((l + b * (z + y)) / (1 + 2 * b))[measured]  # eq. 10a
    from_h = sizes.get("neighbours", "l") == "h"
    candidates = (h[measured][up], h[measured][low]) if from_h else (above, below)
    z, memory = prior(k, h, *candidates, memory)  # eq. 10b
    kept, other = (h, z) if network["filtered_iterate"] == "h" else (z, h)
    kept_m = kept * scale_m
    q = outliers(np.where(kept_m < sensor["min_range_m"], 0, kept_m), network["filter"])
    y = np.where(q, 0 if network["rejected_pixel"] == "zero" else other, kept)  # eq. 10c
    check(f"layers.{k}.rejected", q)
    for name, image in [("h", h), ("z", z), ("y", y)]:
        check(f"layers.{k}.{name}", image, scale_m)
result_m = z * scale_m
result_m[(result_m < sensor["min_range_m"]) | (result_m > sensor["max_range_m"])] = 0
result_m[measured] = measured_m
last = outliers(result_m, network["last_filter"])
check("rejected", last)
result_m[last] = 0
check("result", result_m)
if not tensors:
    worst["self_test.expected"] = np.abs(z * scale_m - weights["self_test.expected"]).max()
for name, difference in worst.items():
    print(f"{name:20} largest difference {difference:.1e}")
