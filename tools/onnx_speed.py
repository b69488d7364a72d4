#!/usr/bin/env python3
"""How fast ONNX Runtime runs the published sizes of SRAE and TULIP, and the files to measure hqslam with.

    tools/onnx_speed.py srae-64|tulip-96|srae-8|... [--threads 1,2] [--runs 20] [--out FOLDER]

The number is SRAE's filters or TULIP's channels. Weights are random, one pass without dropout. Writes
NETWORK.onnx and what `hqslam weights pack` takes, and prints the commands that measure hqslam on the
same network. Needs PyTorch and

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
from layers import save_arrays
from srae import Srae
from tulip import Tulip

HEADS = {96: [3, 6, 12, 24], 48: [3, 6, 12, 24]}


def described(name):
    kind, size = name.split("-")
    network = {"kind": kind, "sensor": "os1-64", "measured_rows": 16}
    if kind == "srae":
        network.update(filters=int(size), dropout=0.25, passes=1, largest_deviation=0.03,
                       range_scale_m=100)
    else:
        network.update(channels=int(size), heads=HEADS.get(int(size), [2, 4, 8]),
                       circular_attention=False, range_scale_m=80)
    spelled_out = {**network, "sensor": {"beam_elevation_deg": [0.0] * 64},
                   "measured_rows": {"offset": 3, "stride": 4}}
    return network, (Srae if kind == "srae" else Tulip)(spelled_out).eval()


class Image(torch.nn.Module):
    """What is exported: scans x rows x columns, metres, to the network's own units."""

    def __init__(self, network):
        super().__init__()
        self.network = network

    def forward(self, measured_m):
        return self.network.image(measured_m)


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
    network, module = described(options.network)
    measured_m = 50.0 * torch.rand(16, 1024, dtype=torch.float64)
    save_arrays(out / f"{options.network}_arrays.npz", module, measured_m)
    (out / f"{options.network}.json").write_text(json.dumps(network) + "\n")
    path = str(out / f"{options.network}.onnx")
    scan = measured_m.float()[None]
    torch.onnx.export(Image(module.float()).eval(), (scan,), path, input_names=["measured_m"],
                      output_names=["image"], dynamo=True, external_data=False)
    with torch.no_grad():
        expected = module.image(scan).numpy()
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
        print(f"{options.network}, ONNX Runtime {onnxruntime.__version__}, {threads} threads: "
              f"{statistics.median(wall_ms):.1f} ms, {statistics.median(processor_ms):.1f} ms of the "
              "processor")
    stem = out / options.network
    print(f"hqslam: build/release/tools/hqslam weights pack {stem}_arrays.npz {stem}.json "
          f"--out {stem}.npz && build/release/tools/hqslam bench --weights {stem}.npz")


if __name__ == "__main__":
    main()
