#!/usr/bin/env python3
"""Trains DU-Mix for any beams with PyTorch, on an accelerator if there is one, on the drives that
`hqslam-lab train` has simulated with rows enough to draw sensors out of them.

    tools/pytorch/train_any_beams.py WEIGHTS.npz DRIVES OUT.npz [--steps N] [--batch N]
        [--sensors N] [--learning-rate R] [--average-steps N] [--seed N]

WEIGHTS, DRIVES: as for train.py. A sample is a sensor with a scan of its own. Sensors are drawn
before the first step, as hqslam draws them (drawn_beams.cpp), and put on canvases: seven of 8
beams, four of 16, two of 32 or one of 64. A step takes `batch` canvases, of three on average.
"""

import math

import numpy
import torch

import hqslam  # the tables of the presets; `pip install .`

from any_beams import AnyBeams, layout_of
from train import MIRRORED, parser_of, read_drives, recipe_of, save, train, validation_drives

CANVAS_ROWS, EMPTY_ROWS, COMPUTED_ROWS = 72, 2, 3
# Measured rows, stride, how often, smallest and largest gap between measured rows in degrees.
COUNTS = ((16, 4, 0.60, 1.0, 4.0), (16, 2, 0.08, 0.6, 3.0), (32, 2, 0.12, 0.6, 2.8),
          (32, 4, 0.10, 1.0, 2.8), (64, 2, 0.04, 0.5, 1.4), (8, 4, 0.06, 1.5, 5.0))
PRESETS, EVEN, SHORT_SIGHTED = 0.25, 0.6, 0.3


class Random:
    """splitmix64, as nn/src/random.h."""

    def __init__(self, seed):
        self.state = seed

    def bits(self):
        self.state = v = (self.state + 0x9E3779B97F4A7C15) % 2**64
        v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9 % 2**64
        v = (v ^ (v >> 27)) * 0x94D049BB133111EB % 2**64
        return v ^ (v >> 31)

    def below(self, count):
        return int(self.unit() * count)

    def unit(self):
        return (self.bits() >> 11) * 2.0**-53

    def between(self, low, high):
        return low + self.unit() * (high - low)


def drawn_table(beams, smallest_gap, largest_gap, random):
    """Elevations of the measured rows, degrees, from the top, around 0."""
    gap = smallest_gap * (largest_gap / smallest_gap) ** random.unit()
    is_even, change, table = random.unit() < EVEN, 0.0, [0.0]
    for _ in range(1, beams):
        change = min(max(change + random.between(-0.35, 0.35), -1.0), 1.0)
        table.append(table[-1] - gap * (1.0 if is_even else math.exp(0.6 * change)))
    return numpy.asarray(table) - 0.5 * table[-1]


def with_rows_between(table, offset, stride):
    place = (numpy.arange(len(table) * stride) - offset) / stride
    above = numpy.clip(numpy.floor(place).astype(int), 0, len(table) - 2)
    return table[above] + (place - above) * (table[above + 1] - table[above])


def nearest_rows(all_deg, wanted_deg):
    """Indices of rows near these elevations, each below the one before it."""
    last, rows = len(all_deg) - 1, [-1]
    lowest_first = numpy.abs(numpy.asarray(all_deg)[::-1, None] - wanted_deg)
    for i, nearest in enumerate(last - lowest_first.argmin(0)):
        rows.append(min(max(nearest, rows[-1] + 1), last + 1 - len(wanted_deg) + i))
    return rows[1:]


def drawn_beams(dense, presets, random):
    """Rows of the dense scan; offset and stride of the measured ones; column step; max_range_m."""
    rest = random.unit()
    for beams, stride, share, smallest_gap, largest_gap in COUNTS:
        if rest < share:
            break
        rest -= share
    if random.unit() < PRESETS:  # of as many rows, or of a multiple of them
        fitting = [table for table in presets if len(table) % beams == 0]
        table = fitting[random.below(len(fitting))]
        every = len(table) // beams
        table = table[every - 1 :: every]
    else:
        table = drawn_table(beams, smallest_gap, largest_gap, random)
    is_centred = abs(table[0] + table[-1]) < 2e-9
    shift = random.between(-12.0, 3.0)  # sensors look down more than up
    table = table + (shift if is_centred else 0.15 * shift)
    offset = random.below(stride) if random.unit() < 0.4 else stride - 1
    rows = nearest_rows(dense["beam_elevation_deg"], with_rows_between(table, offset, stride))
    column_step, max_range_m = 1 if random.unit() < 0.5 else 2, float(dense["max_range_m"])
    if random.unit() < SHORT_SIGHTED:
        max_range_m *= random.between(0.3, 1.0)
    return rows, offset, stride, column_step, max_range_m


def sensor_layout(dense, rows, offset, stride, column_step, max_range_m):
    """The sensor's layout, and what its rows read of a dense scan."""
    layout = layout_of(numpy.asarray(dense["beam_elevation_deg"])[rows], offset, stride,
                       dense["columns"] // column_step)
    tiles = numpy.reshape(rows, (-1, stride))
    layout["computed_row"] = numpy.delete(tiles, offset, 1)
    for name in ("phi", "is_above", "part", "share", "computed_row"):
        missing = [(0, 0), (0, COMPUTED_ROWS + 1 - stride), (0, 0)]
        layout[name] = numpy.pad(layout[name], missing[: layout[name].ndim])
    return {**layout, "measured_row": tiles[:, offset],
            "column_step": numpy.full(len(tiles), column_step),
            "max_range_m": numpy.full(len(tiles), max_range_m)}


def canvas(layouts):
    """Of several sensors. Empty rows read something, which `there` and `share` then remove."""
    begin, whole = 0, {}
    for name, value in layouts[0].items():
        kind = numpy.float32 if value.dtype == float else value.dtype
        whole[name] = numpy.zeros((CANVAS_ROWS, *value.shape[1:]), kind)
    whole["column_step"][:] = 1
    for layout in layouts:
        end = begin + len(layout["there"])
        for name, value in layout.items():
            whole[name][begin:end] = value + begin if name in ("top", "bottom") else value
        begin = end + EMPTY_ROWS
    return whole


def drawn_canvases(dense, sensors, seed, device):
    """The layouts of canvases; the sensors of one have the same number of beams."""
    presets = [numpy.degrees(hqslam.load_sensor(name).beam_elevation_rad)
               for name in hqslam.sensor_preset_names()]
    random, waiting, canvases = Random(seed), {}, []
    for _ in range(sensors):
        layout = sensor_layout(dense, *drawn_beams(dense, presets, Random(random.bits())))
        beams = len(layout["there"])
        waiting.setdefault(beams, []).append(layout)
        if len(waiting[beams]) == CANVAS_ROWS // (beams + EMPTY_ROWS):
            canvases.append(canvas(waiting.pop(beams)))
    return {name: torch.from_numpy(numpy.stack([one[name] for one in canvases])).to(device)
            for name in canvases[0]}


def samples(scans, layout, random, augmentation, min_range_m):
    """As seen_by and augmentation.cpp: measured ranges, and the truth of computed pixels, metres.
    random (4 x canvases x rows, 0 to 1) draws a scan, turn, mirroring and scale for each sensor."""
    scan, turn, mirrored, scale = random.gather(2, layout["top"].expand_as(random))[..., None]
    step, max_range_m = layout["column_step"][..., None], layout["max_range_m"][..., None]
    columns, crop = scans.shape[2] // step, augmentation["crop_columns"]
    column = torch.arange(crop, device=scans.device)
    column = torch.where(mirrored < MIRRORED, crop - 1 - column, column)
    column = ((turn * columns).long() + column) % columns * step
    smallest, largest = augmentation["smallest_scale"], augmentation["largest_scale"]
    scan, scale = (scan * len(scans)).long(), (smallest + scale * (largest - smallest)).float()

    def ranges_m(row):
        range_m = scans[scan, row[..., None], column]
        range_m = torch.where(range_m <= max_range_m, range_m, 0.0) * scale
        return torch.where((range_m >= min_range_m) & (range_m <= max_range_m), range_m, 0.0)

    measured_m = ranges_m(layout["measured_row"]) * layout["there"][..., None]
    return measured_m, torch.stack([ranges_m(row) for row in layout["computed_row"].unbind(2)], 2)


def main():
    options = parser_of(__doc__, steps=200_000, batch=8, sensors=24_000, learning_rate=2e-3,
                        average_steps=3000, seed=1).parse_args()
    device = "cuda" if torch.cuda.is_available() else "cpu"
    module, recipe = AnyBeams.load(options.weights).float().to(device), recipe_of(options.weights)
    dense, augmentation = recipe["drawn_from"], recipe["augmentation"]
    layouts = drawn_canvases(dense, options.sensors, options.seed, device)
    scans = read_drives(options.drives, validation_drives(recipe), device)
    count = len(layouts["there"])
    print(f"{len(scans)} scans, {options.sensors} sensors on {count} canvases, {device}")

    @torch.compile(dynamic=False, disable=device == "cpu")
    def loss_on(layout, numbers):
        measured_m, truth_m = samples(scans, layout, numbers, augmentation, dense["min_range_m"])
        with torch.autocast(device, torch.bfloat16, enabled=device == "cuda"):
            return module.loss(measured_m, truth_m, layout)

    def loss_of(random):
        chosen = torch.randint(count, (options.batch,), generator=random, device=device)
        numbers = torch.rand((4, options.batch, CANVAS_ROWS), generator=random, device=device,
                             dtype=torch.float64)
        return loss_on({name: value[chosen] for name, value in layouts.items()}, numbers)

    train(module, loss_of, options, options.average_steps)
    save(module, options)


if __name__ == "__main__":
    main()
