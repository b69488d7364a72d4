"""The Python module as its users have it: python_test.sh runs it where hqslam can be imported."""

import inspect
import json
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path
from typing import NamedTuple

import numpy as np

import hqslam

class SimulatedScan(NamedTuple):
    range_m: np.ndarray
    stamp_s: float
    T_map_sensor: np.ndarray
    T_map_sensor_at_column: np.ndarray


def simulated(name, *options):
    """A drive of hqslam-lab, the first argument of this program, and its scans with the truth."""
    folder = Path(FOLDER.name) / name
    command = [LABORATORY, "simulate", "--drive", "block", *options, "--out", folder]
    subprocess.run(command, check=True, capture_output=True)
    truth = hqslam.read_trajectory(folder / "truth.tum")
    columns = np.load(folder / "truth_columns.npy")  # x y z qx qy qz qw
    qx, qy, qz, qw = q = np.moveaxis(columns[..., 3:], -1, 0)
    cross = np.array([[0 * qx, -qz, qy], [qz, 0 * qx, -qx], [-qy, qx, 0 * qx]])
    rotation = (2 * qw**2 - 1) * np.eye(3)[..., None, None] + 2 * qw * cross
    at_column = np.zeros((*columns.shape[:2], 4, 4))
    at_column[..., :3, :3] = np.moveaxis(rotation + 2 * q[:3, None] * q[None, :3], (0, 1), (2, 3))
    at_column[..., :3, 3] = columns[..., :3]
    at_column[..., 3, 3] = 1.0
    ranges = np.load(folder / "scans.npy")
    return folder, [
        SimulatedScan(*scan) for scan in zip(ranges, truth.stamp_s, truth.T_map_sensor, at_column)
    ]


LABORATORY = sys.argv.pop(1)
FOLDER = tempfile.TemporaryDirectory()
SENSOR = hqslam.load_sensor("os1-16")
RECORDING, DRIVE = simulated("drive", "--sensor", "os1-16", "--scans", "12")
WEIGHTS = hqslam.weights("du-mix_any-beams")


def run_slam(trace=None, **options):
    slam = hqslam.Pipeline(SENSOR, **options)
    reports = [
        slam.process(hqslam.unproject(scan.range_m, SENSOR), scan.stamp_s, trace=trace).report
        for scan in DRIVE
    ]
    slam.finish()
    return slam, reports


class Arrays(unittest.TestCase):
    def test_look_at_the_scans_own_memory(self):
        cloud = hqslam.unproject(DRIVE[0].range_m, SENSOR)
        self.assertEqual(cloud.points_m.shape, (16, 1024, 3))
        self.assertTrue(np.shares_memory(cloud.range_m, cloud.range_m))
        np.testing.assert_allclose(
            np.linalg.norm(cloud.points_m, axis=2), cloud.range_m, rtol=1e-5
        )

    def test_outlive_what_they_came_from(self):
        points_m = hqslam.unproject(DRIVE[0].range_m, SENSOR).points_m
        before = points_m.copy()
        _ = [hqslam.unproject(DRIVE[1].range_m, SENSOR) for _ in range(10)]
        np.testing.assert_array_equal(points_m, before)

    def test_may_be_of_other_types_and_orders(self):
        upsampler = hqslam.Upsampler("linear", hqslam.load_sensor("os1-64"), measured_rows=16)
        image = DRIVE[0].range_m
        expected = upsampler.run(image).range_m
        for other in (image.astype(np.float64), np.asfortranarray(image), image.tolist()):
            given = other if isinstance(other, np.ndarray) else np.array(other)
            np.testing.assert_array_equal(upsampler.run(given).range_m, expected)

    def test_take_what_a_calibration_found(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "calibrated.json"
            hqslam.write_sensor_json(SENSOR, str(path))
            fields = json.loads(path.read_text())
            fields["elevation_correction_deg"] = [0.0] * 16
            fields["range_correction_m"] = [0.1] * 16
            path.write_text(json.dumps(fields))
            sensor = hqslam.load_sensor(str(path))
        cloud = hqslam.unproject(DRIVE[0].range_m, sensor)
        seen = cloud.range_m > 0
        np.testing.assert_allclose(
            hqslam.calibrated(cloud, sensor).range_m[seen], cloud.range_m[seen] + 0.1, rtol=1e-5
        )

    def test_of_a_driver_give_the_same_scan(self):
        cloud = hqslam.unproject(DRIVE[0].range_m, SENSOR)
        seen = cloud.range_m > 0
        row = np.nonzero(seen)[0].astype(np.uint16)
        again = hqslam.project(cloud.points_m[seen], SENSOR, row, cloud.time_offset_s[seen])
        np.testing.assert_array_equal(again.points_m, cloud.points_m)


    def test_of_a_trajectory_are_those_that_it_was_made_of(self):
        stamps = np.array([scan.stamp_s for scan in DRIVE])
        poses = np.stack([scan.T_map_sensor for scan in DRIVE])
        trajectory = hqslam.Trajectory(stamps, poses)
        kept = trajectory.T_map_sensor
        np.testing.assert_array_equal(trajectory.stamp_s, stamps)
        del trajectory
        np.testing.assert_allclose(kept, poses, atol=1e-12)
        self.assertEqual(DRIVE[0].T_map_sensor_at_column.shape, (1024, 4, 4))


    def test_are_the_same_from_a_pickle(self):
        trajectory = hqslam.Trajectory(
            np.array([scan.stamp_s for scan in DRIVE]), np.stack([scan.T_map_sensor for scan in DRIVE])
        )
        again = pickle.loads(pickle.dumps(trajectory))
        np.testing.assert_array_equal(again.stamp_s, trajectory.stamp_s)
        np.testing.assert_allclose(again.T_map_sensor, trajectory.T_map_sensor, atol=1e-12)
        self.assertRegex(repr(again), r"Trajectory\(12 poses, [0-9.]+ m\)")


class Sensors(unittest.TestCase):
    def test_are_the_same_from_a_pickle(self):
        for sensor in (SENSOR, hqslam.Upsampler("du-mix", SENSOR).sensor):
            self.assertEqual(pickle.loads(pickle.dumps(sensor)), sensor)

    def test_that_are_equal_are_one_key(self):
        again = hqslam.load_sensor("os1-16")
        self.assertEqual(again, SENSOR)
        self.assertEqual({SENSOR: "found"}.get(again), "found")


class Recordings(unittest.TestCase):
    def test_give_what_the_sensor_measured(self):
        folder, _ = simulated("imu", "--sensor", "os1-16", "--scans", "2", "--imu")
        recording = hqslam.open_recording(folder)
        self.assertEqual(recording.size, 2)
        scans = list(recording)
        self.assertEqual(len(scans), 2)
        np.testing.assert_array_equal(scans[1].cloud.range_m, DRIVE[1].range_m)
        intensity = scans[1].cloud.intensity
        self.assertEqual(intensity.shape, (16, 1024))
        self.assertTrue(np.isfinite(intensity[scans[1].cloud.range_m > 0]).all())
        samples = np.concatenate([scan.imu for scan in scans])
        self.assertEqual(samples.shape[1], 7)
        self.assertGreater(len(samples), 15)  # a hundred a second
        upsampled = hqslam.Upsampler(WEIGHTS, SENSOR).upsampled_cloud(scans[1].cloud)
        self.assertEqual(upsampled.intensity.shape, (64, 1024))
        slam = hqslam.Pipeline(SENSOR)
        slam.process(scans[1].cloud, 0.0)
        map_intensity = slam.map_intensity()
        self.assertEqual(len(map_intensity), len(slam.map_points_m()))
        self.assertTrue((map_intensity > 0).all() and (map_intensity <= intensity.max()).all())


class Errors(unittest.TestCase):
    def test_are_one_line_that_says_what_was_expected(self):
        for wrong in (
            lambda: hqslam.load_sensor("os9"),
            lambda: hqslam.weights("du-nothing"),
            lambda: hqslam.open_recording("/nowhere.pcap"),
            lambda: hqslam.Upsampler(WEIGHTS, SENSOR).run(np.zeros((5, 7), np.float32)),
            lambda: hqslam.Pipeline(SENSOR, options={"mapping.no_such": 1.0}),
            lambda: hqslam.Pipeline(SENSOR, T_map_level_start=np.eye(4)),
            lambda: hqslam.Pipeline(SENSOR, slam="other"),
            lambda: hqslam.Trajectory(np.zeros(2), np.zeros((2, 4, 4))),
            lambda: hqslam.Trajectory(np.array([0.0, 2.0, 1.0]), np.stack(3 * [np.eye(4)])),
            lambda: hqslam.Trajectory(np.array([0.0, np.nan]), np.stack(2 * [np.eye(4)])),
            lambda: hqslam.project(np.zeros((5, 3)), SENSOR, np.full(5, 16, np.uint16)),
        ):
            with self.assertRaises(hqslam.Error) as raised:
                wrong()
            self.assertNotIn("\n", str(raised.exception))
        with self.assertRaisesRegex(hqslam.Error, "expected a rotation .*, found .*; "):
            hqslam.Trajectory(np.zeros(1), 2 * np.eye(4)[None])
        self.assertTrue(issubclass(hqslam.ScanError, hqslam.Error))
        with self.assertRaises(hqslam.ScanError):
            cloud = hqslam.unproject(DRIVE[0].range_m, SENSOR)
            cloud.time_offset_s[:] = 1e9
            hqslam.Pipeline(SENSOR).process(cloud, 0.0)


class Slam(unittest.TestCase):
    def test_gives_the_programs_trajectory(self):
        slam, reports = run_slam()
        self.assertEqual(reports[-1].mapping_status, "ok")
        self.assertEqual(reports[-1].covariance.shape, (6, 6))
        with tempfile.TemporaryDirectory() as folder:
            run = {"cwd": folder, "check": True, "capture_output": True}
            subprocess.run([hqslam.program, "run", RECORDING, "--out", "results"], **run)
            slam.trajectory().write_tum(Path(folder) / "own.tum")
            self.assertEqual(
                (Path(folder) / "own.tum").read_text(),
                (Path(folder) / "results" / "trajectory.tum").read_text(),
            )

    def test_of_scans_without_intensities_has_a_map_without(self):
        slam, _ = run_slam()
        self.assertGreater(len(slam.map_points_m()), 100)
        self.assertEqual(slam.map_intensity().shape, (0,))

    def test_is_near_the_truth(self):
        slam, _ = run_slam()
        stamps = np.array([scan.stamp_s for scan in DRIVE])
        truth = hqslam.Trajectory(stamps, np.stack([scan.T_map_sensor for scan in DRIVE]))
        error = hqslam.absolute_pose_error(slam.trajectory(), truth)
        self.assertLess(error.translation_statistics.rmse, 0.05)
        self.assertEqual(error.translation_m.shape, (12,))
        relative = hqslam.relative_pose_error(slam.trajectory(), truth, stretch_m=0.3)
        self.assertGreater(len(relative.translation_m), 0)
        self.assertGreater(hqslam.drift(slam.trajectory(), truth, piece_m=0.3).pieces, 0)

    def test_shows_its_stages(self):
        trace = {}
        _, reports = run_slam(trace=trace)
        self.assertEqual(trace["pixel_class"].shape, (16, 1024))
        features = len(trace["features.kind"])
        self.assertEqual(trace["features.point_m"].shape, (features, 3))
        self.assertEqual(set(trace["features.kind"]), {0, 1, 2, 3})
        self.assertEqual(trace["features.is_matched"].dtype, bool)
        distance_m = np.linalg.norm(trace["features.point_m"], axis=1)
        self.assertGreater(distance_m.min(), 0.4)
        np.testing.assert_allclose(trace["T_map_level"][:3, 3], reports[-1].T_map_sensor[:3, 3])

    def test_is_located_in_a_saved_map(self):
        slam, reports = run_slam()
        with tempfile.TemporaryDirectory() as folder:
            slam.saved_map().write(Path(folder) / "map.npz")
            saved = hqslam.read_saved_map(Path(folder) / "map.npz")
        self.assertEqual(saved.planes_m.shape[1], 3)
        later = hqslam.Pipeline(SENSOR, map=saved, T_map_level_start=reports[0].T_map_sensor)
        cloud = hqslam.unproject(DRIVE[3].range_m, SENSOR)
        found = later.process(cloud, DRIVE[3].stamp_s).report
        gap_m = np.linalg.norm(found.T_map_sensor[:3, 3] - reports[3].T_map_sensor[:3, 3])
        self.assertLess(gap_m, 0.1)


class Pipeline(unittest.TestCase):
    def test_computes_as_many_rows_as_a_spacing_needs(self):
        spacing_rad = np.deg2rad(1.2)
        pipeline = hqslam.Pipeline(SENSOR, WEIGHTS, spacing_rad=spacing_rad)
        upsampler = hqslam.Upsampler(WEIGHTS, SENSOR, spacing_rad=spacing_rad)
        self.assertEqual(pipeline.sensor, upsampler.sensor)
        self.assertEqual(upsampler.sensor.rows, 32)  # those of the OS1-16 are 2.1 degrees apart
        gaps_rad = -np.diff(upsampler.sensor.beam_elevation_rad)
        self.assertLessEqual(gaps_rad.max(), spacing_rad)

    def test_upsamples_a_recordings_scans_and_locates_them(self):
        recording = hqslam.open_recording(RECORDING)
        pipeline = hqslam.Pipeline(recording.sensor, "du-mix-memory")
        located = [pipeline.process(scan) for scan in recording]
        self.assertEqual(located[-1].cloud.range_m.shape, (64, 1024))
        self.assertEqual(pipeline.sensor.rows, 64)
        self.assertEqual(located[-1].report.mapping_status, "ok")
        self.assertGreater(located[-1].upsampling_s, 0.0)


class Maps(unittest.TestCase):
    def test_are_those_of_the_program(self):
        recording = hqslam.open_recording(RECORDING)
        pipeline = hqslam.Pipeline(recording.sensor)
        clouds = [pipeline.process(scan).cloud for scan in recording]
        pipeline.finish()
        of_drive = (clouds, pipeline.sensor, pipeline.trajectory())
        dense = hqslam.dense_map(*of_drive)
        grid = hqslam.occupancy_grid(*of_drive, resolution_m=0.2)
        with tempfile.TemporaryDirectory() as folder:
            results = Path(folder) / "results"
            maps = ["--dense-map", "--occupancy-grid", "--grid-cell", "0.2"]
            command = [hqslam.program, "run", RECORDING, *maps, "--out", results]
            subprocess.run(command, check=True, capture_output=True)
            header = (results / "dense_map.pcd").read_bytes()[:400]
            grid.write(Path(folder) / "own.yaml")
            for end in (".pgm", ".yaml"):
                own = (Path(folder) / "own").with_suffix(end).read_bytes()
                of_program = (results / "map").with_suffix(end).read_bytes()
                self.assertEqual(own.replace(b"own.pgm", b"map.pgm"), of_program)
        self.assertIn(b"POINTS %d\n" % len(dense["points_m"]), header)
        self.assertGreater(dense["confidence"].min(), 0.5)
        self.assertEqual(set(np.unique(grid.cells)), {0, 1, 2})

    def test_leave_out_scans_whose_pose_is_not_known(self):
        slam, _ = run_slam()
        cloud = hqslam.unproject(DRIVE[0].range_m, SENSOR)
        alone = hqslam.dense_map([cloud] + [None] * 11, SENSOR, slam.trajectory())
        self.assertEqual(set(alone["times_seen"]), {1})
        with self.assertRaisesRegex(hqslam.Error, "12 poses"):
            hqslam.dense_map([cloud], SENSOR, slam.trajectory())


class Upsampling(unittest.TestCase):
    def test_keeps_measured_rows_and_says_how_sure_it_is(self):
        upsampler = hqslam.Upsampler(WEIGHTS, SENSOR)
        upsampled = upsampler.run(DRIVE[0].range_m)
        rows = upsampler.sensor.measured_rows
        np.testing.assert_array_equal(upsampled.range_m[rows], DRIVE[0].range_m)
        self.assertEqual(upsampled.confidence.shape, (64, 1024))
        cloud = hqslam.unproject(DRIVE[0].range_m, upsampler.measured_sensor)
        self.assertEqual(upsampler.upsampled_cloud(cloud).points_m.shape, (64, 1024, 3))

    def test_shows_every_tensor(self):
        trace = {}
        result = hqslam.SuperResolver(WEIGHTS).run(DRIVE[0].range_m, trace=trace)
        np.testing.assert_array_equal(trace["result"][0], result.range_m)
        self.assertGreater(len(trace), 10)


    def test_looks_ahead(self):
        upsampler = hqslam.Upsampler(hqslam.weights("du-mix-memory_os1_16to64"))
        memory = hqslam.ScanMemory(upsampler.sensor, look_ahead=True)
        rows = upsampler.sensor.measured_rows
        _, scans = simulated("look_ahead", "--sensor", "os1-64", "--scans", "2")
        for scan in scans:
            cloud = hqslam.unproject(scan.range_m[rows], upsampler.measured_sensor)
            memory.insert(cloud, scan.T_map_sensor_at_column, scan.stamp_s)
        of_first, of_last = (
            memory.recall(scan.range_m[rows], scan.T_map_sensor_at_column, itself_s=scan.stamp_s)
            for scan in scans
        )
        self.assertGreater((of_first.range_m > 0).sum(), 5000)
        self.assertEqual((of_last.range_m > 0).sum(), 0)  # it stands; no scan recalls itself

    def test_recalls_what_earlier_scans_measured(self):
        upsampler = hqslam.Upsampler(hqslam.weights("du-mix-memory_os1_16to64"))
        memory = hqslam.ScanMemory(upsampler.sensor)
        _, scans = simulated("recall", "--sensor", "os1-64", "--scans", "8")
        for scan in scans:
            measured_m = scan.range_m[upsampler.sensor.measured_rows]
            recalled = memory.recall(measured_m, scan.T_map_sensor_at_column)
            cloud = hqslam.unproject(measured_m, upsampler.measured_sensor)
            memory.insert(cloud, scan.T_map_sensor_at_column, scan.stamp_s)
        both = (recalled.range_m > 0) & (scan.range_m > 0) & (recalled.weight > 0)
        self.assertGreater(both.sum(), 10000)
        self.assertLess(np.median(np.abs(recalled.range_m - scan.range_m)[both]), 0.05)
        upsampled = upsampler.run(measured_m, recalled)
        error_m = [
            np.abs(image.range_m - scan.range_m)[scan.range_m > 0].mean()
            for image in (upsampled, upsampler.run(measured_m))
        ]
        self.assertLess(error_m[0], error_m[1])
        inside = {}
        resolver = hqslam.SuperResolver(hqslam.weights("du-mix-memory_os1_16to64"))
        traced = resolver.run(measured_m, trace=inside, recalled=recalled)
        np.testing.assert_array_equal(traced.range_m, upsampled.range_m)
        np.testing.assert_array_equal(inside["recalled"][0], recalled.range_m)
        with_memory = upsampler.upsampled_cloud(cloud, recalled)
        np.testing.assert_array_equal(with_memory.range_m > 0, upsampled.range_m > 0)
        memory.clear()
        nothing = memory.recall(measured_m, np.eye(4)).range_m
        self.assertEqual(nothing.size, 0)
        with self.assertRaises(hqslam.Error):
            memory.recall(measured_m, np.eye(3))


class Threads(unittest.TestCase):
    def test_go_on_beside_a_call(self):
        upsampler = hqslam.Upsampler(WEIGHTS, SENSOR, threads=1)
        expected = upsampler.run(DRIVE[0].range_m).range_m.copy()
        results = []
        work = lambda: results.append(upsampler.run(DRIVE[0].range_m).range_m)
        threads = [threading.Thread(target=work) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for result in results:
            np.testing.assert_array_equal(result, expected)

    def test_that_are_daemons_end_with_the_process(self):
        code = f"""
import threading, time
import hqslam, numpy

def upsample():
    upsampler = hqslam.Upsampler("{WEIGHTS}", hqslam.load_sensor("os1-16"))
    scan = numpy.full((16, 1024), 10, "f4")
    while True:
        upsampler.run(scan)

for _ in range(3):
    threading.Thread(target=upsample, daemon=True).start()
time.sleep(1)
"""
        ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))

    def test_ctrl_c_ends_a_drive(self):
        code = f"""
import hqslam
pipeline = hqslam.Pipeline(hqslam.load_sensor("os1-16"))
while True:
    for scan in hqslam.open_recording("{RECORDING}"):
        pipeline.process(scan)
        print(".", flush=True)
"""
        drive = subprocess.Popen(
            [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        drive.stdout.readline()
        time.sleep(0.5)
        drive.send_signal(signal.SIGINT)
        _, complaint = drive.communicate(timeout=60)
        self.assertIn("KeyboardInterrupt", complaint)


class Speed(unittest.TestCase):
    def test_is_that_of_the_library(self):
        """What a call adds, against what it does: SLAM's own time of a scan, and a network's call
        against one that does next to nothing."""
        slam = hqslam.Pipeline(SENSOR)
        network = hqslam.Upsampler(WEIGHTS, SENSOR)
        nearest = hqslam.Upsampler("nearest", network.sensor, measured_rows=16)
        taken_s = {"slam": [], "slam inside": [], "network": [], "nearest": []}

        def timed(name, work):
            start_s = time.perf_counter()
            result = work()
            taken_s[name].append(time.perf_counter() - start_s)
            return result

        for scan in DRIVE:
            cloud = hqslam.unproject(scan.range_m, SENSOR)
            report = timed("slam", lambda: slam.process(cloud, scan.stamp_s)).report
            taken_s["slam inside"].append(report.time_s)
            timed("network", lambda: network.run(scan.range_m))
            timed("nearest", lambda: nearest.run(scan.range_m))
        median_s = {name: np.median(times) for name, times in taken_s.items()}
        added_s = np.median(np.subtract(taken_s["slam"], taken_s["slam inside"]))
        print({name: f"{1e3 * s:.3f} ms" for name, s in {**median_s, "added": added_s}.items()})
        self.assertLess(added_s, 0.05 * median_s["slam"])
        self.assertLess(median_s["nearest"], 0.05 * median_s["network"])


class Documentation(unittest.TestCase):
    def test_says_shape_and_unit_of_every_array(self):
        for name, member in inspect.getmembers(hqslam):
            if name.startswith("_") or inspect.ismodule(member) or name == "program":
                continue
            self.assertTrue(member.__doc__, name)
            if not inspect.isclass(member) or issubclass(member, Exception):
                continue
            for field, value in vars(member).items():
                if field.startswith("_") or value is None:
                    continue
                with self.subTest(f"{name}.{field}"):
                    self.assertTrue(value.__doc__)
                    if field.endswith("_m") and name != "Upsampler":
                        self.assertRegex(value.__doc__.lower(), r"metres|errors")


if __name__ == "__main__":
    unittest.main()
