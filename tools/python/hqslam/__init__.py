"""LiDAR super-resolution and SLAM on plain CPUs.

Metres, radians and seconds. Row 0 of an image is the highest beam, 0 m is no return. Poses are 4 x 4
float64 matrices: T_map_sensor takes points of the sensor's frame to the map's.
"""

import os
from importlib.metadata import version
from pathlib import Path

# Threads that wait for each other soon sleep, as in the program; read when the library is loaded.
_spins = {"GOMP_SPINCOUNT", "OMP_WAIT_POLICY"}.isdisjoint(os.environ)
if _spins:
    os.environ["GOMP_SPINCOUNT"] = "2000"
from ._hqslam import *  # noqa: E402, F403
from ._hqslam import Error  # noqa: E402

if _spins:
    del os.environ["GOMP_SPINCOUNT"]

__version__ = version("hqslam")

#: The program hqslam, for subprocess.run([hqslam.program, "train", ...]).
program = Path(__file__).parent / "bin" / "hqslam"


def weights(name: str) -> Path:
    """The file of weights that come with hqslam: du-mix_any-beams, ... Raises Error."""
    folder = Path(__file__).parent / "share" / "hqslam" / "weights"
    path = folder / f"{name}.npz"
    if not path.is_file():
        names = ", ".join(sorted(file.stem for file in folder.glob("*.npz")))
        raise Error(f"no weights are called '{name}'; choose one of {names}")
    return path
