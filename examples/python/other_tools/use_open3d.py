"""The first scan upsampled, as a cloud with normals of Open3D's: python use_open3d.py RECORDING"""

import sys

import open3d as o3d

import hqslam

recording = hqslam.open_recording(sys.argv[1])
upsampler = hqslam.Upsampler("du-mix", recording.sensor)
upsampled = upsampler.upsampled_cloud(upsampler.measured(next(recording).cloud))
points_m = upsampled.points_m[upsampled.range_m > 0]
cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points_m))
cloud.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(radius=1.0, max_nn=30))
o3d.io.write_point_cloud("upsampled.ply", cloud)
print(cloud)
# Where there is a screen: o3d.visualization.draw_geometries([cloud])
