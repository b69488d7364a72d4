"""A simulated drive as a data set of evalio: evalio_dataset.py DRIVE writes DRIVE/points.npz with
hqslam; evalio then reads it without, because it forks."""

import sys
from collections.abc import Iterator
from enum import auto
from pathlib import Path

import numpy as np
from evalio.datasets import Dataset, DatasetIterator, RawDataIter
from evalio.types import SE3, Duration, ImuParams, LidarMeasurement, LidarParams, Point, Stamp, Trajectory

HALF_A_SCAN_S = 0.05  # evalio counts from a scan's beginning, hqslam from its middle


class Simulated(Dataset):
    drive = auto()

    def measurements(self) -> Iterator[LidarMeasurement]:
        scans = np.load(Path("drive/points.npz"))
        for stamp_s, points_m, time_s in zip(scans["stamp_s"], scans["points_m"], scans["time_s"]):
            yield LidarMeasurement(
                Stamp.from_sec(stamp_s - HALF_A_SCAN_S),
                [
                    Point(x=x, y=y, z=z, row=row, col=column, t=Duration.from_sec(t + HALF_A_SCAN_S))
                    for row in range(points_m.shape[0])
                    for column, ((x, y, z), t) in enumerate(zip(points_m[row], time_s[row]))
                ],
            )

    def data_iter(self) -> DatasetIterator:
        return RawDataIter(self.measurements(), iter([]), self.quick_len())

    def ground_truth_raw(self) -> Trajectory:
        fields = ["sec", "x", "y", "z", "qx", "qy", "qz", "qw"]
        return Trajectory.from_csv(Path("drive/truth.tum"), fields, delimiter=" ")

    def imu_T_lidar(self) -> SE3:
        return SE3.identity()

    def imu_T_gt(self) -> SE3:
        return SE3.identity()

    def imu_params(self) -> ImuParams:
        return ImuParams()

    def lidar_params(self) -> LidarParams:
        return LidarParams(num_rows=16, num_columns=1024, min_range=0.5, max_range=120.0)

    def files(self) -> list[Path]:
        return [Path("drive/points.npz")]

    def quick_len(self) -> int:
        return len(np.load("drive/points.npz")["stamp_s"])


if __name__ == "__main__":
    import hqslam

    scans = list(hqslam.open_recording(sys.argv[1]))
    np.savez(
        Path(sys.argv[1]) / "points.npz",
        stamp_s=[scan.stamp_s for scan in scans],
        points_m=[scan.cloud.points_m for scan in scans],
        time_s=[scan.cloud.time_offset_s for scan in scans],
    )
