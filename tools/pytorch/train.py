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


def validation_drives(weights):
    """Names and seeds of the drives that the recipe keeps to validate on."""
    with numpy.load(weights) as arrays:
        recipe = json.loads(bytes(arrays["description"]).decode())["training"]["configuration"]
    drives = set()
    for entry in recipe["validation"]:
        seeds = entry.get("seeds", [])
        if isinstance(seeds, dict):
            seeds = range(seeds["first"], seeds["first"] + seeds["count"])
        drives |= {(entry.get("drive"), seed) for seed in seeds}
    return drives


def read_drives(folder, left_out, rows, device):
    """Scans x (all rows; with a memory M and W^2 below them) x columns."""
    scans = []
    for path in sorted(pathlib.Path(folder).glob("*_*_*.npy")):  # as drive_store.cpp names them
        name, seed, _ = path.stem.rsplit("_", 2)
        if (name, int(seed)) not in left_out:
            scans.append(torch.from_numpy(numpy.load(path)).to(device))
    if not scans:
        raise SystemExit(f"{folder}: no drives to train on; hqslam-lab train --drives makes them")
    scans = torch.cat(scans)
    scans[~(scans.isfinite() & (scans > 0.0))] = 0.0
    if scans.shape[1] == rows:
        scans = torch.nn.functional.pad(scans, (0, 0, 0, 2 * rows))
    return scans


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


def train(module, scans, options, scales):
    device, rows = scans.device, module.rows.count
    random = torch.Generator(device).manual_seed(options.seed)
    optimiser = optimiser_of(module, options.learning_rate)
    learning_rate = cosine_learning_rate(options.learning_rate, options.steps)
    average = [value.detach().clone() for value in module.parameters()]
    begin, loss_sum = time.time(), 0.0
    for step in range(options.steps):
        chosen = torch.randint(len(scans), (options.batch,), generator=random, device=device)
        truth_m, recalled = augmented(scans[chosen], rows, scales, module.limits_m, random)
        for group in optimiser.param_groups:
            group["lr"] = learning_rate(step)
        optimiser.zero_grad()
        loss = module.loss(truth_m[:, module.rows.measured], truth_m, recalled)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(module.parameters(), LARGEST_GRADIENT_NORM)
        optimiser.step()
        follow = min(1.0, max(1.0 / AVERAGE_STEPS, 10.0 / (10.0 + step)))
        for mean, value in zip(average, module.parameters()):
            mean.lerp_(value.detach(), follow)
        loss_sum += loss.detach()
        if (step + 1) % 100 == 0 or step + 1 == options.steps:
            speed = (step + 1) * options.batch / (time.time() - begin)
            print(f"step {step + 1}/{options.steps}  loss {loss_sum / (step % 100 + 1):.4f}  "
                  f"{speed:.0f} scans/s", flush=True)
            loss_sum = 0.0
    with torch.no_grad():
        for mean, value in zip(average, module.parameters()):
            value.copy_(mean)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    for name in ("weights", "drives", "out"):
        parser.add_argument(name)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--learning-rate", type=float, default=7e-4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scales", type=float, nargs=2, default=(0.15, 1.1))
    options = parser.parse_args()
    device = "cuda" if torch.cuda.is_available() else "cpu"
    torch.set_float32_matmul_precision("high")
    torch.manual_seed(options.seed)
    module = DuMix.load(options.weights).float().to(device)
    left_out = validation_drives(options.weights)
    scans = read_drives(options.drives, left_out, module.rows.count, device)
    print(f"{len(scans)} scans on {device}")
    train(module, scans, options, options.scales)
    with numpy.load(options.weights) as arrays:
        measured_m = torch.from_numpy(arrays["self_test.measured"]).double()
    save_arrays(options.out, module.cpu().double(), measured_m)


if __name__ == "__main__":
    main()
