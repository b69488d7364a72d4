#include "hqslam/core/trajectory.h"

#include "testing.h"

namespace {

Trajectory a_long_drive() {
  Trajectory trajectory;
  for (int i = 0; i < 500; ++i) {
    trajectory.push_back({1.7e9 + 0.1 * i, pose_from_xyz_rpy({1234.5 + i, -8000.123456789 * i, 0.1},
                                                             0.01 * i, 0.9 * std::sin(i), i)});
  }
  return trajectory;
}

double largest_difference(const Trajectory& a, const Trajectory& b) {
  REQUIRE(a.size() == b.size());
  double difference = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Matrix4d d = a[i].T_map_sensor.matrix() - b[i].T_map_sensor.matrix();
    difference = std::max(difference, d.cwiseAbs().maxCoeff());
  }
  return difference;
}

Trajectory read_any(const std::string& path) { return read_trajectory_file(path).poses; }

}  // namespace

TEST_CASE("the path length is the sum of the straight distances between poses") {
  const Trajectory corner = {{0.0, pose_from_xyz_rpy({1, 2, 3}, 0.0, 0.0, 1.5707963267948966)},
                             {1.0, pose_from_xyz_rpy({1, 5, 3}, 0.0, 0.0, 0.0)},
                             {2.0, pose_from_xyz_rpy({5, 5, 3}, 0.1, 0.2, 0.3)}};
  CHECK(path_length_m(corner) == doctest::Approx(7.0));
  CHECK(path_length_m({}) == 0.0);
  CHECK(path_length_m({corner.front()}) == 0.0);
}

TEST_CASE("a trajectory written as TUM comes back to a nanometre with its stamps") {
  const TemporaryDirectory directory;
  const Trajectory drive = a_long_drive();
  write_tum(drive, directory.file("t.tum"));
  const Trajectory back = read_tum(directory.file("t.tum"));
  CHECK(largest_difference(drive, back) < 1e-9);
  CHECK(back[321].stamp_s == doctest::Approx(drive[321].stamp_s).epsilon(1e-15));
  // Stamp, position and quaternion x y z w.
  write_tum({{12.5, pose_from_xyz_rpy({1, -2, 3}, 0, 0, 1.5707963267948966)}},
            directory.file("t.tum"));
  CHECK(file_contents(directory.file("t.tum")) ==
        "12.500000000 1.000000000 -2.000000000 3.000000000 "
        "0.000000000000 0.000000000000 0.707106781187 0.707106781187\n");
}

TEST_CASE("a trajectory written as KITTI comes back with stamps from the period") {
  const TemporaryDirectory directory;
  const Trajectory drive = a_long_drive();
  write_kitti_poses(drive, directory.file("t.kitti"));
  const Trajectory back = read_kitti_poses(directory.file("t.kitti"), 0.05);
  // Relative to the distance from the origin, 4000 km at most here.
  CHECK(largest_difference(drive, back) < 4e6 * 1e-12);
  CHECK(back[100].stamp_s == doctest::Approx(5.0));
}

TEST_CASE("comments, empty lines, tabs and carriage returns are accepted") {
  const Trajectory trajectory = from_file(
      "t", "# stamp x y z qx qy qz qw\r\n\n1 1 2 3 0 0 0 1\r\n\t2e0\t4 5 6 0 0 1.0 0 # half\n",
      read_any);
  REQUIRE(trajectory.size() == 2);
  CHECK(trajectory[1].stamp_s == 2.0);
  CHECK(trajectory[1].T_map_sensor.translation() == Eigen::Vector3d(4, 5, 6));
  CHECK(trajectory[1].T_map_sensor(0, 0) == doctest::Approx(-1.0));
}

TEST_CASE("a file that is no trajectory is refused with its name and its first wrong line") {
  const auto refuses_by = [](const auto& read, const std::string& contents, const auto&... parts) {
    CAPTURE(contents);
    CHECK(refused_with([&] { from_file("poses.txt", contents, read); }, parts...));
  };
  const auto refuses = [&](const auto&... with) { refuses_by(read_any, with...); };
  refuses("", "poses.txt", "at least one pose");
  refuses_by(read_tum, "# only a comment\n", "at least one pose");
  refuses("\n1 2 3\n", "poses.txt:2", "8", "12", "found 3");
  refuses("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0\n", "poses.txt:2", "expected 8 numbers", "found 7");
  refuses("1\n2\nthree\n", "poses.txt:1", "found 1");
  refuses_by(read_tum, "0 0 0 0 0 0 0 1\n1\ntwo\n", "poses.txt:2", "found 1");
  refuses("0 0 0 0 0 0 0 one\n", "poses.txt:1", "'one'");
  refuses("0 0 0 nan 0 0 0 1\n", "'nan'");
  refuses("0 0 0 1e999 0 0 0 1\n", "'1e999'");
  refuses("0 0 0 0 0 0 0 0\n", "unit quaternion", "norm 0");
  refuses("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "poses.txt:2", "rise");
  refuses("1 0 0 0 0 1 0 0 0 0 -1 0\n", "rotation", "determinant -1");
  refuses("2 0 0 0 0 2 0 0 0 0 2 0\n", "rotation");
  refuses(std::string("\0\1\2binary\n", 10), "poses.txt:1", "finite number");
  refuses_by([](const auto& path) { return read_kitti_poses(path); },
             "1 2 3 4 5 6 7 8 9 10 11 12 13 14", "expected 12", "more than 12");
  refuses(std::string("\x93NUMPY\1\0v\0", 10), "poses.txt:1", "finite number");
  CHECK(refused_with([] { read_any("/dev/null"); }, "/dev/null", "a trajectory", "found a pipe"));
  const TemporaryDirectory directory;
  const std::string path = directory.file("t.tum");
  write_file(path, "0 0 0 0 0 0 0 1\n");
  std::filesystem::resize_file(path, 1'000'000'000);  // a hole, no blocks
  CHECK(refused_with([&] { read_any(path); }, "t.tum", "at most", "1000000000 bytes"));
  CHECK(refused_with([] { read_tum("/nowhere/t.tum"); }, "/nowhere/t.tum"));
  CHECK(refused_with([] { write_tum({}, "/nowhere/t.tum"); }, "/nowhere/t.tum"));
}

TEST_CASE("the number of columns tells TUM from KITTI, whatever stands in comments") {
  const TemporaryDirectory directory;
  write_file(directory.file("t"), "0 1 2 3 0 0 0 1 # the first pose\n1 1 2 3 0 0 0 1\n");
  CHECK(read_trajectory_file(directory.file("t")).has_stamps);
  CHECK(read_trajectory_file(directory.file("t")).poses.size() == 2);
  write_file(directory.file("k"), "#0 1 2 3 0 0 0 1\n1 0 0 4 0 1 0 5 0 0 1 6 # 1 2 3\n");
  CHECK_FALSE(read_trajectory_file(directory.file("k"), 0.5).has_stamps);
}
