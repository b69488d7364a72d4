
#include <fmt/format.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <filesystem>

#include "arrays.h"
#include "hqslam/core/error.h"
#include "hqslam/core/trajectory.h"
#include "parts.h"
#include "paths.h"

namespace hqslam::python {
namespace {

Trajectory trajectory_of(const Input<double, -1>& stamp_s,
                         const Input<double, -1, 4, 4>& T_map_sensor) {
  if (stamp_s.size() != T_map_sensor.shape(0)) {
    throw Error("Trajectory: {} stamps for {} poses, expected one each", stamp_s.size(),
                T_map_sensor.shape(0));
  }
  Trajectory result;
  result.reserve(stamp_s.size());
  for (std::size_t i = 0; i < stamp_s.size(); ++i) {
    const double next_s = stamp_s.data()[i];
    if (!std::isfinite(next_s) || (i > 0 && !(next_s > result.back().stamp_s))) {
      throw Error(
          "Trajectory: expected finite stamps that rise, found {:.9f} at index {}; sort the poses "
          "by time and leave repeated ones out",
          next_s, i);
    }
    const Matrix4 matrix = Eigen::Map<const Matrix4>(T_map_sensor.data() + 16 * i);
    result.push_back({next_s, pose_of(matrix)});
  }
  return result;
}

Array<double, -1> stamps_of(const Trajectory& trajectory) {
  std::vector<double> stamp_s;
  stamp_s.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) stamp_s.push_back(pose.stamp_s);
  return owned<Array<double, -1>>(std::move(stamp_s), {trajectory.size()});
}

PoseList poses_of(const Trajectory& trajectory) {
  std::vector<Pose> poses;
  poses.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) poses.push_back(pose.T_map_sensor);
  return pose_list(poses);
}

template <auto Write>
void write(const Trajectory& trajectory, const std::filesystem::path& path) {
  Write(trajectory, path.string());
}

}  // namespace

Pose pose_of(const Matrix4& matrix) {
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool is_rigid = matrix.allFinite() && matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
                        (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < 1e-3 &&
                        R.determinant() > 0.0;
  if (!is_rigid) {
    throw Error(
        "pose: expected a rotation R and a translation t as [R t; 0 0 0 1], found another 4 x 4 "
        "matrix; R R^T must be the identity to 0.001 and det R 1");
  }
  return orthonormalized(Pose(Eigen::Matrix4d(matrix)));
}

PoseList pose_list(const std::vector<Pose>& poses) {
  std::vector<double> values(16 * poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Eigen::Map<Matrix4>(values.data() + 16 * i) = poses[i].matrix();
  }
  return owned<PoseList>(std::move(values), {poses.size(), 4, 4});
}

void add_trajectories(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<Trajectory>(module, "Trajectory", "Poses in the order of time.")
      .def(
          "__init__",
          [](Trajectory* self, const Input<double, -1>& stamp_s,
             const Input<double, -1, 4, 4>& T_map_sensor) {
            new (self) Trajectory(trajectory_of(stamp_s, T_map_sensor));
          },
          "stamp_s"_a, "T_map_sensor"_a,
          "stamp_s: (N,), seconds, rising. T_map_sensor: (N, 4, 4), metres. Raises Error.")
      .def("__len__", [](const Trajectory& t) { return t.size(); })
      .def("__repr__",
           [](const Trajectory& t) {
             return fmt::format("Trajectory({} poses, {:.1f} m)", t.size(), path_length_m(t));
           })
      .def("__getstate__", [](const Trajectory& t) { return std::pair(stamps_of(t), poses_of(t)); })
      .def("__setstate__",
           [](Trajectory& t, const std::pair<Input<double, -1>, Input<double, -1, 4, 4>>& state) {
             new (&t) Trajectory(trajectory_of(state.first, state.second));
           })
      .def_prop_ro("stamp_s", &stamps_of, kOwned, "(N,) float64, seconds.")
      .def_prop_ro("T_map_sensor", &poses_of, kOwned,
                   "(N, 4, 4) float64: takes points of the sensor's frame to the map's, metres.")
      .def_prop_ro("path_length_m", &path_length_m, "Length of the path, metres.")
      .def("write_tum", &write<write_tum>, "path"_a,
           "Writes \"stamp x y z qx qy qz qw\" a line. Raises Error.")
      .def("write_kitti_poses", &write<write_kitti_poses>, "path"_a,
           "Writes the upper three rows of each matrix, a line each. Raises Error.");
  module.def(
      "read_trajectory",
      [](const std::filesystem::path& path, double period_s) {
        return read_trajectory_file(path.string(), period_s).poses;
      },
      "path"_a, "period_s"_a = 0.1,
      "Reads TUM's form, or KITTI's, whose stamps are counted by period_s. Raises Error.");
}

}  // namespace hqslam::python
