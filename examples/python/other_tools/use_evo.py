"""evo's absolute pose error of hqslam's trajectory: python use_evo.py RECORDING REFERENCE.tum"""

import sys

from evo.core import metrics, sync
from evo.core.trajectory import PoseTrajectory3D

import hqslam

recording = hqslam.open_recording(sys.argv[1])
pipeline = hqslam.Pipeline(recording.sensor)
for scan in recording:
    pipeline.process(scan)
pipeline.finish()
paths = hqslam.read_trajectory(sys.argv[2]), pipeline.trajectory()
ours = hqslam.absolute_pose_error(paths[1], paths[0]).translation_statistics.rmse

evo_paths = [PoseTrajectory3D(timestamps=p.stamp_s, poses_se3=list(p.T_map_sensor)) for p in paths]
reference, estimate = sync.associate_trajectories(*evo_paths)
estimate.align(reference)
ape = metrics.APE(metrics.PoseRelation.translation_part)
ape.process_data((reference, estimate))
print(f"APE RMSE: evo {ape.get_statistic(metrics.StatisticsType.rmse):.6f} m, hqslam {ours:.6f} m")
