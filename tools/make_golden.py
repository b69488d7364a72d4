#!/usr/bin/env python3
"""Makes the files of tests/golden with programs that are not hqslam, for its tests to compare with.

    tools/make_golden.py            all sections
    tools/make_golden.py npz ...    these sections

The files are part of the repository; nothing in the build needs this script.
"""

import pathlib
import sys

import numpy

GOLDEN = pathlib.Path(__file__).resolve().parent.parent / "tests" / "golden"


def make_npz():
    """Arrays of every dtype that hqslam reads, packed by numpy. tests/core/npz_test.cpp has the same
    values."""
    arrays = {
        "float32": numpy.array([[0.5, -1.25, 3.0], [numpy.inf, 1e-40, -0.0]], "<f4"),
        "float64": numpy.array([0.1, -1e300], "<f8"),
        "int64": numpy.array([[-1], [2**62]], "<i8"),
        "int32": numpy.array([-(2**31), 7], "<i4"),
        "uint8": numpy.frombuffer("Grüße".encode(), "|u1"),
        "int8": numpy.array([-128, 127], "|i1"),
        "bool": numpy.array([True, False, True], "|b1"),
        "scalar": numpy.array(42, "<i8"),
        "empty": numpy.zeros((0, 3), "<f4"),
        # Long enough that deflate has something to gain.
        "ramp": (numpy.arange(3000) % 50).astype("<f4").reshape(3, 10, 100),
        "nested/näme": numpy.array([1.0], "<f4"),
    }
    numpy.savez(GOLDEN / "numpy_stored.npz", **arrays)
    numpy.savez_compressed(GOLDEN / "numpy_deflated.npz", **arrays)


SECTIONS = {"npz": make_npz}


def main(names):
    unknown = [name for name in names if name not in SECTIONS]
    if unknown:
        sys.exit(f"no section {', '.join(unknown)}; there are {', '.join(SECTIONS)}")
    GOLDEN.mkdir(exist_ok=True)
    for name in names or SECTIONS:
        SECTIONS[name]()
        print(f"{name}: made in {GOLDEN}")


if __name__ == "__main__":
    main(sys.argv[1:])
