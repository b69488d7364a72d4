"""hqslam's SLAM as a pipeline of evalio (https://github.com/contagon/evalio), which compares LiDAR
odometries on public recordings:

    pip install evalio .
    export EVALIO_CUSTOM=hqslam.evalio
    evalio run -d hilti_2022/construction_upper_level_1 -p hqslam -o results

Scans alone are used, not the inertial sensor. evalio keeps every pose as it was first given, so
loop closing, which corrects past ones too, is off unless it is asked for.
"""
# mypy: disable-error-code="import-not-found,misc"

import json
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import hqslam
import numpy as np
from evalio.pipelines import Pipeline
from evalio.types import SE3, Duration, ImuMeasurement, ImuParams, LidarMeasurement, LidarParams

LEAST_POINTS_OF_A_ROW = 20


def sensor_of(elevation_deg: np.ndarray, params: LidarParams) -> hqslam.SensorModel:
    """A sensor with these beams, from the highest to the lowest."""
    model = {
        "name": params.model,
        "columns": params.num_columns,
        "scan_period_s": 1.0 / params.rate,
        "min_range_m": max(params.min_range, 0.1),
        "max_range_m": params.max_range,
        "beam_elevation_deg": elevation_deg.tolist(),
        "beam_azimuth_offset_deg": [0.0] * len(elevation_deg),
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sensor.json"
        path.write_text(json.dumps(model))
        return hqslam.load_sensor(path)


class Hqslam(Pipeline):
    def __init__(self) -> None:
        super().__init__()
        self.params: dict[str, Any] = dict(self.default_params())
        self.lidar_T_imu: np.ndarray = np.eye(4)
        self.slam: hqslam.Pipeline | None = None
        self.row_of_ring: np.ndarray = np.empty(0, np.uint16)  # 65535: has no beam

    @staticmethod
    def name() -> str:
        return "hqslam"

    @staticmethod
    def version() -> str:
        return hqslam.__version__

    @staticmethod
    def default_params() -> dict[str, bool | int | float | str]:
        return {"threads": 0, "loop_closing": False}

    def set_params(self, params: Mapping[str, Any]) -> dict[str, Any]:
        self.params |= {name: value for name, value in params.items() if name in self.params}
        return {name: value for name, value in params.items() if name not in self.params}

    def set_imu_params(self, params: ImuParams) -> None: ...
    def add_imu(self, mm: ImuMeasurement) -> None: ...
    def initialize(self) -> None: ...
    def map(self) -> dict[str, list[Any]]:
        return {}

    def set_lidar_params(self, params: LidarParams) -> None:
        self.lidar = params

    def set_imu_T_lidar(self, T: SE3) -> None:
        self.lidar_T_imu = np.linalg.inv(T.to_mat())

    def begin(self, points_m: np.ndarray, ring: np.ndarray) -> hqslam.Pipeline:
        """The elevation of each ring is the median of its points in the first scan."""
        elevation_deg = np.degrees(np.arctan2(points_m[:, 2], np.hypot(*points_m[:, :2].T)))
        count = np.bincount(ring, minlength=self.lidar.num_rows)
        rings = np.flatnonzero(count >= LEAST_POINTS_OF_A_ROW)
        of_ring = np.array([np.median(elevation_deg[ring == r]) for r in rings])
        order = np.argsort(-of_ring)
        self.row_of_ring = np.full(len(count), 65535, np.uint16)
        self.row_of_ring[rings[order]] = np.arange(len(rings))
        return hqslam.Pipeline(sensor_of(of_ring[order], self.lidar), **self.params)

    def add_lidar(self, mm: LidarMeasurement) -> None:
        points_m = np.array(mm.to_vec_positions(), np.float32).reshape(-1, 3)
        ring = np.array([point.row for point in mm.points], np.int64)
        seconds = np.array(mm.to_vec_stamps(), np.float32)
        seen = np.isfinite(points_m).all(axis=1) & (points_m != 0).any(axis=1)
        points_m, ring, seconds = points_m[seen], ring[seen], seconds[seen]
        if self.slam is None:
            self.slam = self.begin(points_m, ring)
        row = self.row_of_ring[np.minimum(ring, len(self.row_of_ring) - 1)]
        known = row != 65535
        half_s = 0.5 / self.lidar.rate  # evalio's stamp is the scan's beginning, hqslam's its middle
        stamp = mm.stamp + Duration.from_sec(half_s)
        try:
            report = self.slam.process(
                points_m[known], stamp.to_sec(), row[known], seconds[known] - np.float32(half_s)
            ).report
        except hqslam.ScanError as error:
            print(error)
            return
        self.save(stamp, SE3.from_mat(report.T_map_sensor @ self.lidar_T_imu))
