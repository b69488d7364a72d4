#!/usr/bin/env python3
"""How fast ONNX Runtime runs the networks of hqslam, and how to measure hqslam on the same.

    tools/onnx_speed.py srae-64|srae-8|... [--threads 1,2] [--runs 20] [--out FOLDER]
    tools/onnx_speed.py weights/du-or_os1_16to64.npz|weights/du-mix-memory_os1_16to64.npz [...]

The number is that of SRAE's filters, 64 as published: its weights are random, one pass without dropout,
and what `hqslam weights pack` takes is written beside NETWORK.onnx. Of a file the weights are its own.
DU-OR's BFS filter, which no graph of ONNX has, is left
out of what ONNX Runtime is given. Needs PyTorch and

    pip install onnx onnxscript onnxruntime
"""

import argparse
import json
import pathlib
import statistics
import sys
import time

import numpy
import torch

sys.path.insert(0, str(pathlib.Path(__file__).parent / "pytorch"))
from du_mix import DuMix
from du_or import DuOr
from layers import describe, save_arrays
from srae import Srae


def described(name):
    kind, filters = name.split("-")
    if kind != "srae":
        sys.exit(f"{name}: expected srae-FILTERS or a weights file")
    network = {"kind": kind, "sensor": "os1-64", "measured_rows": 16, "filters": int(filters),
               "dropout": 0.25, "passes": 1, "largest_deviation": 0.03, "range_scale_m": 100}
    spelled_out = {**network, "sensor": {"beam_elevation_deg": [0.0] * 64},
                   "measured_rows": {"offset": 3, "stride": 4}}
    return network, Srae(spelled_out).eval()


class Image(torch.nn.Module):
    """What is exported: scans x rows x columns, metres, to the network's own units."""

    def __init__(self, network):
        super().__init__()
        self.network = network

    def forward(self, measured_m):
        return self.network.image(measured_m)


class Upsampled(torch.nn.Module):
    """What is exported of DU-OR and DU-Mix: measured rows, metres, to all that a frame needs, before
    pixels are emptied."""

    def __init__(self, network):
        super().__init__()
        self.network = network.float()
        network.part = network.part.float()
        network.rows.mask = network.rows.mask.float()

    def forward(self, measured_m):
        return tuple(self.network(measured_m).values())


def unrolled(path):
    """DU-OR or DU-Mix of a weights file, without DU-OR's filter."""
    if describe(path)[0]["kind"] == "du-mix":
        return Upsampled(DuMix.load(path))
    network = DuOr.load(path, lambda h: h)
    network.find_outliers = None
    return Upsampled(network)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("network")
    parser.add_argument("--threads", default="1,2", help="separated by commas")
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--out", default="onnx", help="folder")
    options = parser.parse_args()
    import onnxruntime

    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    torch.manual_seed(1)
    if options.network.endswith(".npz"):
        name, module = pathlib.Path(options.network).stem, unrolled(options.network)
        scan = 50.0 * torch.rand(16, 1024)
        measure = f"hqslam-lab bench --weights {options.network}"
    else:
        name = options.network
        network, published = described(name)
        measured_m = 50.0 * torch.rand(16, 1024, dtype=torch.float64)
        save_arrays(out / f"{name}_arrays.npz", published, measured_m)
        (out / f"{name}.json").write_text(json.dumps(network) + "\n")
        module, scan = Image(published.float()), measured_m.float()[None]
        stem = out / name
        measure = (f"hqslam weights pack {stem}_arrays.npz {stem}.json --out {stem}.npz && "
                   f"hqslam-lab bench --weights {stem}.npz")
    path = str(out / f"{name}.onnx")
    torch.onnx.export(module.eval(), (scan,), path, input_names=["measured_m"], dynamo=True,
                      external_data=False)
    with torch.no_grad():
        expected = module(scan)
    expected = (expected[0] if isinstance(expected, tuple) else expected).numpy()
    for threads in map(int, options.threads.split(",")):
        session = onnxruntime.SessionOptions()
        session.intra_op_num_threads = threads
        run = onnxruntime.InferenceSession(path, session, providers=["CPUExecutionProvider"])
        feed = {"measured_m": scan.numpy()}
        off = numpy.abs(run.run(None, feed)[0] - expected).max() / (numpy.abs(expected).max() + 1e-6)
        assert off < 1e-3, f"ONNX Runtime says something else than PyTorch: {off}"
        wall_ms, processor_ms = [], []
        for _ in range(options.runs):
            start, processor = time.perf_counter(), time.process_time()
            run.run(None, feed)
            wall_ms.append(1e3 * (time.perf_counter() - start))
            processor_ms.append(1e3 * (time.process_time() - processor))
        print(f"{name}, ONNX Runtime {onnxruntime.__version__}, {threads} threads: "
              f"{statistics.median(wall_ms):.1f} ms, {statistics.median(processor_ms):.1f} ms of the "
              "processor")
    print(f"hqslam: {measure}")


if __name__ == "__main__":
    main()
