#!/usr/bin/env python3
"""Trains DU-Mix with PyTorch, on an accelerator if there is one, on the drives that `hqslam-lab train` has
simulated: the loss, augmentation and schedule of hqslam, in larger batches.

    tools/pytorch/train.py WEIGHTS.npz DRIVES OUT.npz [--steps N] [--batch N] [--learning-rate R] [--seed N]

WEIGHTS: what it begins with, of `hqslam-lab train` (after a single step: random ones). DRIVES: the folder
of its --drives; all of it is held in the device's memory, 0.8 MB for each scan that recalls.
"""

import argparse
import json
import math
import pathlib
import time

import numpy
import torch

from du_mix import DuMix
from layers import save_arrays

FORGOTTEN, MIRRORED = 0.1, 0.5
WARM_UP_STEPS, WEIGHT_DECAY, LARGEST_GRADIENT_NORM, AVERAGE_STEPS = 300, 0.01, 1.0, 500


def recipe_of(weights):
    with numpy.load(weights) as arrays:
        return json.loads(bytes(arrays["description"]).decode())["training"]["configuration"]


def validation_drives(recipe):
    """Names and seeds of the drives that the recipe keeps to validate on."""
    drives = set()
    for entry in recipe["validation"]:
        seeds = entry.get("seeds", [])
        if isinstance(seeds, dict):
            seeds = range(seeds["first"], seeds["first"] + seeds["count"])
        drives |= {(entry.get("drive"), seed) for seed in seeds}
    return drives


def read_drives(folder, left_out, device):
    """Scans x (all rows; M and W^2 below them where the drives have them) x columns."""
    scans = []
    for path in sorted(pathlib.Path(folder).glob("*_*_*.npy")):  # as drive_store.cpp names them
        name, seed, _ = path.stem.rsplit("_", 2)
        if (name, int(seed)) not in left_out:
            drive = torch.from_numpy(numpy.load(path))
            scans.append(torch.where(drive.isfinite() & (drive > 0.0), drive, 0.0))
    if not scans:
        raise SystemExit(f"{folder}: no drives to train on; hqslam-lab train --drives makes them")
    return torch.cat(scans).to(device)


def augmented(scans, rows, scales, limits_m, random):
    """As nn/training/src/augmentation.cpp: truth, M and W^2 of each, turned, mirrored and scaled."""
    count, columns, device = len(scans), scans.shape[2], scans.device

    def drawn(shape=(count, 1)):
        return torch.rand(shape, generator=random, device=device)

    column = torch.arange(columns, device=device)
    column = torch.where(drawn() < MIRRORED, columns - 1 - column, column)
    column = (column + (drawn() * columns).long()) % columns
    scans = scans.gather(2, column[:, None].expand(-1, scans.shape[1], -1))
    scale = scales[0] + drawn((count, 1, 1)) * (scales[1] - scales[0])
    range_m = scans[:, : 2 * rows] * scale
    range_m = range_m * ((range_m >= limits_m[0]) & (range_m <= limits_m[1]))
    weight = scans[:, 2 * rows :] * (drawn((count, 1, 1)) >= FORGOTTEN)
    return range_m[:, :rows], (range_m[:, rows:], weight)


def cosine_learning_rate(highest, steps):
    def at(step):
        if step < WARM_UP_STEPS:
            return highest * (step + 1) / WARM_UP_STEPS
        part = (step - WARM_UP_STEPS) / max(1, steps - WARM_UP_STEPS)
        return highest * 0.5 * (1.0 + math.cos(math.pi * min(1.0, part)))
    return at


def optimiser_of(module, learning_rate):
    """Weight decay pulls at the weights of convolutions alone."""
    named = list(module.named_parameters())
    weights = [value for name, value in named if name.endswith("weight")]
    others = [value for name, value in named if not name.endswith("weight")]
    return torch.optim.AdamW([{"params": weights, "weight_decay": WEIGHT_DECAY},
                              {"params": others, "weight_decay": 0.0}], lr=learning_rate)


def train(module, loss_of, options, average_steps=AVERAGE_STEPS):
    """loss_of(random): the module's loss on a batch that it draws."""
    random = torch.Generator(next(module.parameters()).device).manual_seed(options.seed)
    optimiser = optimiser_of(module, options.learning_rate)
    learning_rate = cosine_learning_rate(options.learning_rate, options.steps)
    average = [value.detach().clone() for value in module.parameters()]
    begin, loss_sum = time.time(), 0.0
    for step in range(options.steps):
        for group in optimiser.param_groups:
            group["lr"] = learning_rate(step)
        optimiser.zero_grad()
        loss = loss_of(random)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(module.parameters(), LARGEST_GRADIENT_NORM)
        optimiser.step()
        follow = min(1.0, max(1.0 / average_steps, 10.0 / (10.0 + step)))
        for mean, value in zip(average, module.parameters()):
            mean.lerp_(value.detach(), follow)
        loss_sum += loss.detach()
        if (step + 1) % 100 == 0 or step + 1 == options.steps:
            speed = (step + 1) / (time.time() - begin)
            print(f"step {step + 1}/{options.steps}  loss {loss_sum / (step % 100 + 1):.4f}  "
                  f"{speed:.1f} steps/s", flush=True)
            loss_sum = 0.0
    with torch.no_grad():
        for mean, value in zip(average, module.parameters()):
            value.copy_(mean)


def parser_of(description, **defaults):
    parser = argparse.ArgumentParser(description=description.split("\n\n")[0])
    for name in ("weights", "drives", "out"):
        parser.add_argument(name)
    for name, value in defaults.items():
        parser.add_argument("--" + name.replace("_", "-"), type=type(value), default=value)
    return parser


def save(module, options):
    with numpy.load(options.weights) as arrays:
        measured_m = torch.from_numpy(arrays["self_test.measured"]).double()
    save_arrays(options.out, module.cpu().double(), measured_m)


def main():
    parser = parser_of(__doc__, steps=10_000, batch=16, learning_rate=7e-4, seed=1)
    parser.add_argument("--scales", type=float, nargs=2, default=(0.15, 1.1))
    options = parser.parse_args()
    device = "cuda" if torch.cuda.is_available() else "cpu"
    torch.set_float32_matmul_precision("high")
    torch.manual_seed(options.seed)
    module = DuMix.load(options.weights).float().to(device)
    scans = read_drives(options.drives, validation_drives(recipe_of(options.weights)), device)
    rows = module.rows.count
    if scans.shape[1] == rows:  # nothing recalled
        scans = torch.nn.functional.pad(scans, (0, 0, 0, 2 * rows))
    print(f"{len(scans)} scans on {device}")

    def loss_of(random):
        chosen = torch.randint(len(scans), (options.batch,), generator=random, device=device)
        truth_m, recalled = augmented(scans[chosen], rows, options.scales, module.limits_m, random)
        return module.loss(truth_m[:, module.rows.measured], truth_m, recalled)

    train(module, loss_of, options)
    save(module, options)


if __name__ == "__main__":
    main()
