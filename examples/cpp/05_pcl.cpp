// Thins a cloud with PCL's VoxelGrid: 05_pcl IN.pcd OUT.ply LEAF_M. Link hqslam::pcl.
#include <hqslam/core/cloud_file.h>
#include <hqslam/core/error.h>
#include <hqslam/pcl.h>
#include <pcl/filters/voxel_grid.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) try {
  if (argc != 4) return 2;
  const hqslam::Scan scan = hqslam::read_cloud(argv[1]);
  const float leaf_m = std::strtof(argv[3], nullptr);

  pcl::VoxelGrid<pcl::PointXYZI> grid;
  grid.setInputCloud(hqslam::pcl_cloud(scan).makeShared());
  grid.setLeafSize(leaf_m, leaf_m, leaf_m);
  pcl::PointCloud<pcl::PointXYZI> thinned;
  grid.filter(thinned);

  hqslam::write_cloud(hqslam::scan_of(thinned), argv[2]);
  std::printf("%zu of %zu points\n", thinned.size(), scan.points_m.size());
} catch (const hqslam::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
