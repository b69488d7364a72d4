#include "hqslam/pcl.h"

#include <pcl/filters/voxel_grid.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include "front_end/voxel_thinning.h"
#include "hqslam/core/cloud_file.h"
#include "points.h"
#include "slam/random_unit.h"

using PclCloud = pcl::PointCloud<pcl::PointXYZI>;

namespace {

Scan random_scan(int points, float reach_m) {
  std::mt19937 generator(5);
  Scan scan;
  for (int i = 0; i < points; ++i) {
    scan.points_m.push_back(reach_m * random_vector(generator).cast<float>());
    scan.intensity.push_back(static_cast<float>(generator() % 256));
  }
  return scan;
}

void check_same(const Scan& a, const Scan& b) {
  CHECK(a.points_m == b.points_m);
  CHECK(a.intensity == b.intensity);
}

}  // namespace

TEST_CASE("an organized cloud goes to PCL and back, without a return where there is none") {
  OrganizedCloud cloud(2, 3);
  cloud.points_m[4] = {3.0F, 4.0F, 0.0F};
  cloud.range_m[4] = 5.0F;
  cloud.intensity.assign(6, std::nanf(""));
  cloud.intensity[4] = 7.0F;
  const PclCloud pcl = pcl_cloud(cloud);
  REQUIRE(pcl.isOrganized());
  CHECK(pcl.at(1, 1).y == 4.0F);
  CHECK(std::isnan(pcl.at(0, 1).x));
  const OrganizedCloud again = organized_cloud(pcl);
  CHECK(again.points_m == cloud.points_m);
  CHECK(again.range_m == cloud.range_m);
  CHECK(again.intensity[4] == 7.0F);
  CHECK(scan_of(pcl).points_m.size() == 1);
  CHECK(scan_of(pcl).invalid_points == 5);
}

TEST_CASE("thinning gives the points that PCL's VoxelGrid gives") {
  const Scan scan = random_scan(20000, 4.0F);
  std::vector<slam::FeaturePoint> features;
  for (const Eigen::Vector3f& point_m : scan.points_m) features.push_back({point_m, 0.0F, 0});
  std::vector<slam::FeaturePoint> ours = slam::thin(features, 0.5);
  std::ranges::sort(ours, {}, [](const slam::FeaturePoint& point) {  // as VoxelGrid's are
    const Eigen::Array3f voxel = (2.0F * point.point_m).array().floor();
    return std::tuple(voxel.z(), voxel.y(), voxel.x());
  });
  PclCloud theirs;
  pcl::VoxelGrid<pcl::PointXYZI> grid;
  grid.setLeafSize(0.5F, 0.5F, 0.5F);
  grid.setInputCloud(pcl_cloud(scan).makeShared());
  grid.filter(theirs);
  REQUIRE(ours.size() == theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    CHECK((ours[i].point_m - theirs[i].getVector3fMap()).norm() < 1e-5F);
  }
}

TEST_CASE("a cloud with more voxels than VoxelGrid can number is thinned like any other") {
  PclCloud cloud = pcl_cloud(random_scan(2000, 4.0F));
  const std::size_t thinned = lego_loam::thinned(cloud, 0.5F).size();
  cloud.push_back(pcl_point({900.0F, 900.0F, 900.0F}, 0.0F));
  cloud.push_back(pcl_point({-900.0F, -900.0F, -900.0F}, 0.0F));
  CHECK(lego_loam::thinned(cloud, 0.5F).size() == thinned + 2);
}

TEST_CASE("what PCL writes as PCD or PLY is read as PCL has it") {
  const TemporaryDirectory directory;
  const Scan scan = random_scan(500, 50.0F);
  const PclCloud cloud = pcl_cloud(scan);
  const std::string pcd = directory.file("a.pcd");
  const std::string ply = directory.file("a.ply");
  pcl::io::savePCDFileBinary(pcd, cloud);
  check_same(read_cloud(pcd), scan);
  pcl::io::savePCDFileBinaryCompressed(pcd, cloud);
  check_same(read_cloud(pcd), scan);
  pcl::io::savePLYFileBinary(ply, cloud);
  check_same(read_cloud(ply), scan);
  for (const std::string& path : {pcd, ply}) {  // as text, with eight digits
    path == pcd ? pcl::io::savePCDFileASCII(path, cloud) : pcl::io::savePLYFileASCII(path, cloud);
    const Scan read = read_cloud(path);
    REQUIRE(read.points_m.size() == scan.points_m.size());
    for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
      CHECK((read.points_m[i] - scan.points_m[i]).norm() < 1e-4F);
    }
  }
}

TEST_CASE("PCL reads what is written as PCD or PLY") {
  const TemporaryDirectory directory;
  const Scan scan = random_scan(500, 50.0F);
  for (const std::string name : {"b.pcd", "b.ply"}) {
    CAPTURE(name);
    write_cloud(scan, directory.file(name));
    PclCloud read;
    REQUIRE((name == "b.pcd" ? pcl::io::loadPCDFile(directory.file(name), read)
                             : pcl::io::loadPLYFile(directory.file(name), read)) == 0);
    check_same(scan_of(read), scan);
  }
}
