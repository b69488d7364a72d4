#!/usr/bin/env python3
"""Runs other LiDAR odometries on exactly the scans that hqslam sees, for its results to stand beside.

    tools/peers.py DRIVE... [--rows 16,64] [--scans N] [--peers kiss-icp,...] [--hqslam PROGRAM]
                   [--out FOLDER]

DRIVE is a folder written by `hqslam-lab simulate` (or kept by `hqslam-lab table` under drives/). Every scan
is made into points as hqslam does it, of all rows or of 16, with the time of each point within the
sweep. Each peer's trajectory is written as TUM and evaluated by `hqslam evaluate` against the
drive's truth; the table has the columns of `hqslam-lab table --seeds`. Nothing in the build or the tests
needs this script. It needs numpy and whichever peers are wanted:

    pip install numpy kiss-icp kiss-slam genz-icp small_gicp evalio

A peer that is not installed is left out, and said so. Times are those of the peer alone, median per
scan; small-gicp and local-gicp take one thread, the others as many as there are cores.
local-gicp is GICP of small_gicp against the last 20 scans; ct-icp and mad-icp are evalio's.
"""

import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import time

import numpy


class Drive:
    """A simulated drive: scans.npy, sensor.json and truth.tum."""

    def __init__(self, folder, rows, scans=None):
        folder = pathlib.Path(folder)
        self.truth = folder / "truth.tum"
        self.ranges = numpy.load(folder / "scans.npy", mmap_mode="r")
        lines = self.truth.read_text().splitlines()[: min(self.ranges.shape[0], scans or sys.maxsize)]
        self.stamps = [line.split()[0] for line in lines]
        sensor = json.loads((folder / "sensor.json").read_text())
        count, columns = len(sensor["beam_elevation_deg"]), sensor["columns"]
        if count % rows != 0:
            sys.exit(f"{folder}: {rows} rows cannot be chosen evenly from {count}")
        stride = count // rows
        # The last of each stride: rows 3, 7, ..., 63 are 16 of 64.
        self.rows = numpy.arange(stride - 1, count, stride)
        step = 2 * numpy.pi / columns
        elevation = numpy.radians(sensor["beam_elevation_deg"])[self.rows, None]
        offset = numpy.radians(sensor["beam_azimuth_offset_deg"])[self.rows, None]
        # A beam's whole columns are taken out of the image; what is left is its residual azimuth.
        shift = numpy.round(offset / step)
        column = numpy.arange(columns)[None, :]
        azimuth = numpy.pi - (column + 0.5) * step + (offset - shift * step)
        self.direction = numpy.stack(
            [
                numpy.cos(elevation) * numpy.cos(azimuth),
                numpy.cos(elevation) * numpy.sin(azimuth),
                numpy.sin(elevation) * numpy.ones_like(azimuth),
            ],
            axis=-1,
        )
        # When the head measures the pixel, as a fraction of the sweep.
        self.fraction = ((column + shift) % columns + 0.5) / columns

    def __len__(self):
        return len(self.stamps)

    def scan(self, index):
        """Points (N, 3) in metres, as captured, and the fraction of the sweep of each (N,)."""
        ranges = self.ranges[index][self.rows].astype(numpy.float64)
        seen = ranges > 0
        return self.direction[seen] * ranges[seen][:, None], self.fraction[seen]


class Odometry:
    """An odometry with KISS-ICP's interface."""

    def __init__(self, odometry):
        self.odometry = odometry
        self.poses = []

    def step(self, points, fractions):
        self.odometry.register_frame(points, fractions)
        self.poses.append(numpy.array(self.odometry.last_pose))


def kiss_icp():
    from kiss_icp.config import load_config
    from kiss_icp.kiss_icp import KissICP

    config = load_config(None)  # 100 m, voxels of 1 m, de-skewing on: its defaults
    return Odometry(KissICP(config))


def genz_icp():
    from genz_icp.config import load_config
    from genz_icp.genz_icp import GenZICP

    config = load_config(None)
    config.data.deskew = True
    return Odometry(GenZICP(config))


def kiss_slam():
    from kiss_slam.config import load_config
    from kiss_slam.slam import KissSLAM

    class Slam:
        """KISS-ICP with local maps and loop closing; its poses are those at the end of the drive."""

        def __init__(self):
            self.slam = KissSLAM(load_config(None))

        def step(self, points, fractions):
            self.slam.process_scan(points, fractions)

        @property
        def poses(self):
            return self.slam.poses

    return Slam()


def small_gicp():
    import small_gicp as library

    class Gicp:
        """Scan to a map of Gaussian voxels, from a constant velocity; it does not know of sweeps."""

        def __init__(self):
            self.voxels = library.GaussianVoxelMap(1.0)
            self.voxels.set_lru(horizon=100, clear_cycle=10)
            self.motion = numpy.identity(4)
            self.poses = []

        def step(self, points, fractions):
            cloud, _ = library.preprocess_points(points, downsampling_resolution=0.25, num_neighbors=10)
            pose = self.poses[-1] @ self.motion if self.poses else numpy.identity(4)
            if self.poses:
                pose = library.align(self.voxels, cloud, pose).T_target_source
                self.motion = numpy.linalg.inv(self.poses[-1]) @ pose
            self.voxels.insert(cloud, pose)
            self.poses.append(pose)

    return Gicp()


def local_gicp():
    import small_gicp as library

    class LocalGicp:
        """GICP against the points of the last 20 scans, begun at the pose that the last motion and
        six turns about it lead to, the one with most inliers winning. Points are corrected for
        the motion of the sweep, first by the last one and then by the one just found."""

        TURNS_DEG = (0, -15, 15, -30, 30, -45, 45)

        def __init__(self):
            self.motion = numpy.identity(4)
            self.poses = []
            self.recent = []

        def step(self, points, fractions):
            pose = self.poses[-1] if self.poses else numpy.identity(4)
            cloud = self.corrected(points, fractions)
            if self.recent:
                target, tree = library.preprocess_points(
                    numpy.concatenate(self.recent), downsampling_resolution=0.3
                )
                expected = pose @ self.motion
                coarse = self.best_start(target, tree, cloud, pose, expected)
                self.motion = numpy.linalg.inv(pose) @ coarse
                cloud = self.corrected(points, fractions)
                pose = self.align(target, tree, cloud, coarse, 0.4).T_target_source
                self.motion = numpy.linalg.inv(self.poses[-1]) @ pose
            self.poses.append(pose)
            placed = numpy.asarray(cloud.points())[:, :3] @ pose[:3, :3].T + pose[:3, 3]
            self.recent = (self.recent + [placed])[-20:]

        def best_start(self, target, tree, cloud, pose, expected):
            most, best = -1, expected
            for turn_deg in self.TURNS_DEG:
                start = expected
                if turn_deg != 0:
                    c, s = numpy.cos(numpy.radians(turn_deg)), numpy.sin(numpy.radians(turn_deg))
                    start = pose.copy()
                    start[:3, :3] = pose[:3, :3] @ numpy.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
                coarse = self.align(target, tree, cloud, start, 1.0).T_target_source
                fine = self.align(target, tree, cloud, coarse, 0.4)
                if fine.num_inliers > most:
                    most, best = fine.num_inliers, fine.T_target_source
                if turn_deg == 0 and most > 0.9 * cloud.size():
                    break
            return best

        @staticmethod
        def align(target, tree, cloud, start, distance_m):
            return library.align(
                target, cloud, tree, start, registration_type="GICP",
                max_correspondence_distance=distance_m, max_iterations=20,
            )

        def corrected(self, points, fractions):
            """The points as all seen in the middle of the sweep, thinned, with their covariances."""
            moved = numpy.empty_like(points)
            order = numpy.argsort(fractions, kind="stable")
            edges = numpy.flatnonzero(numpy.diff(fractions[order])) + 1
            for column in numpy.split(order, edges):
                part = part_of_motion(self.motion, fractions[column[0]] - 0.5)
                moved[column] = points[column] @ part[:3, :3].T + part[:3, 3]
            return library.preprocess_points(moved, downsampling_resolution=0.4)[0]

    return LocalGicp()


class EvalioPipeline:
    """An odometry that evalio builds, with its defaults there but for `parameters`."""

    PERIOD_S = 0.1

    def __init__(self, pipeline, parameters):
        from evalio import types

        self.types = types
        self.pipeline = pipeline()
        self.pipeline.set_params({**pipeline.default_params(), **parameters})
        self.pipeline.set_lidar_params(
            types.LidarParams(
                num_rows=64, num_columns=1024, min_range=1.0, max_range=120.0, rate=1 / self.PERIOD_S
            )
        )
        self.pipeline.set_imu_T_lidar(types.SE3.identity())
        self.pipeline.initialize()
        self.poses = []

    def prepared(self, points, fractions):
        """evalio's points are objects; making them takes longer than some odometries."""
        stamp = self.types.Stamp.from_sec(1.0 + len(self.poses) * self.PERIOD_S)
        made = [
            self.types.Point(x=x, y=y, z=z, t=self.types.Duration.from_sec(fraction * self.PERIOD_S))
            for (x, y, z), fraction in zip(points.tolist(), fractions.tolist())
        ]
        return (self.types.LidarMeasurement(stamp, made),)

    def step(self, measurement):
        self.pipeline.add_lidar(measurement)
        ((_, pose),) = self.pipeline.saved_estimates()
        self.poses.append(numpy.array(pose.to_mat()))


def ct_icp():
    from evalio.pipelines import CTICP

    return EvalioPipeline(CTICP, {"ls_num_threads": os.cpu_count()})


def mad_icp():
    from evalio.pipelines import MadICP

    # Every scan is registered to the end, however long it takes.
    return EvalioPipeline(MadICP, {"deskew": True, "realtime": False, "num_threads": os.cpu_count()})


# Each with the fraction of the sweep that its poses belong to; hqslam's stamps are at one half.
PEERS = {
    "ct-icp": (ct_icp, 0.0),
    "mad-icp": (mad_icp, 1.0),
    "kiss-icp": (kiss_icp, 1.0),
    "kiss-slam": (kiss_slam, 1.0),
    "genz-icp": (genz_icp, 0.5),
    "small-gicp": (small_gicp, 0.5),
    "local-gicp": (local_gicp, 0.5),
}


def quaternion(rotation):
    """x y z w of a rotation matrix."""
    w = numpy.sqrt(max(0.0, 1.0 + numpy.trace(rotation))) / 2
    if w > 1e-6:
        return [
            (rotation[2, 1] - rotation[1, 2]) / (4 * w),
            (rotation[0, 2] - rotation[2, 0]) / (4 * w),
            (rotation[1, 0] - rotation[0, 1]) / (4 * w),
            w,
        ]
    values, vectors = numpy.linalg.eigh(rotation + rotation.T)
    axis = vectors[:, -1]
    return [*axis, 0.0]


def part_of_motion(motion, share):
    """The same screw motion, by a share of it."""
    angle = numpy.arccos(numpy.clip((numpy.trace(motion[:3, :3]) - 1) / 2, -1, 1))
    result = numpy.identity(4)
    result[:3, 3] = share * motion[:3, 3]
    if angle > 1e-12:
        axis = numpy.array(
            [motion[2, 1] - motion[1, 2], motion[0, 2] - motion[2, 0], motion[1, 0] - motion[0, 1]]
        ) / (2 * numpy.sin(angle))
        cross = numpy.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        part = share * angle
        result[:3, :3] += numpy.sin(part) * cross + (1 - numpy.cos(part)) * cross @ cross
    return result


def at_stamps(poses, fraction):
    """Poses at `fraction` of each sweep, moved to the middle of it along the motion since the last."""
    if fraction == 0.5:
        return poses
    moved = []
    for before, pose in zip([poses[0]] + poses[:-1], poses):
        moved.append(pose @ part_of_motion(numpy.linalg.inv(before) @ pose, 0.5 - fraction))
    moved[0] = poses[0] @ part_of_motion(numpy.linalg.inv(poses[0]) @ poses[1], 0.5 - fraction)
    return moved


def run(drive, system, fraction, path):
    """Writes the trajectory; returns the median of the times in ms."""
    times_ms = []
    for index in range(len(drive)):
        scan = drive.scan(index)
        if hasattr(system, "prepared"):
            scan = system.prepared(*scan)
        start = time.perf_counter()
        system.step(*scan)
        times_ms.append(1e3 * (time.perf_counter() - start))
    with open(path, "w") as stream:
        for stamp, pose in zip(drive.stamps, at_stamps(list(system.poses), fraction)):
            numbers = [*pose[:3, 3], *quaternion(pose[:3, :3])]
            stream.write(stamp + "".join(f" {number:.12f}" for number in numbers) + "\n")
    return statistics.median(times_ms)


def figures(program, trajectory, truth):
    """Drift in % and deg/100 m, slips, slips per 100 km and APE, as `hqslam evaluate` prints them."""
    text = subprocess.run(
        [program, "evaluate", str(trajectory), str(truth)], check=True, capture_output=True, text=True
    ).stdout

    def column(label, index):
        found = re.search(re.escape(label) + r"((?:\s+[-\d.naif]+)+)", text)
        return found.group(1).split()[index] if found else "-"

    return [
        column("RPE % over 100 m", 1),
        column("RPE deg/100 m over 100 m", 1),
        column("slips", 0),
        column("slips", 1),
        column("APE m (align se3)", 0),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("drives", nargs="+", metavar="DRIVE")
    parser.add_argument("--rows", default="16,64", help="of the sensor's, separated by commas")
    parser.add_argument("--scans", type=int, help="scans of each drive that are used")
    parser.add_argument("--peers", default=",".join(PEERS), help="separated by commas")
    parser.add_argument("--hqslam", default="build/release/bin/hqslam", help="the program")
    parser.add_argument("--out", default="peers", help="folder for the trajectories")
    options = parser.parse_args()
    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    print("| Drive | Method | drift, % | drift, deg/100 m | slips | slips per 100 km | APE, m | ms |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for folder in options.drives:
        name = pathlib.Path(folder).resolve().name
        for rows in map(int, options.rows.split(",")):
            drive = Drive(folder, rows, options.scans)
            for peer in options.peers.split(","):
                make, fraction = PEERS[peer]
                trajectory = out / f"{name}-{peer}-{rows}.tum"
                try:
                    system = make()
                except ImportError as error:
                    print(f"{peer}: left out, {error}", file=sys.stderr)
                    continue
                median_ms = run(drive, system, fraction, trajectory)
                cells = figures(options.hqslam, trajectory, drive.truth)
                print(f"| {name} | {peer}, {rows} rows | {' | '.join(cells)} | {median_ms:.1f} |", flush=True)


if __name__ == "__main__":
    main()
