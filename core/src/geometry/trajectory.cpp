#include "hqslam/core/trajectory.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxTrajectoryFileBytes = 128U << 20U;  // more than a million poses
constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;
/// How far a rotation read from rounded numbers may be from a rotation.
constexpr double kRotationTolerance = 1e-2;

enum class Form { kTum, kKitti };

struct Row {
  int line = 0;
  std::vector<double> numbers;
};

template <typename... Values>
[[noreturn]] void fail(const std::string& path, int line, fmt::format_string<Values...> complaint,
                       Values&&... values) {
  throw Error("{}:{}: {}", path, line, fmt::format(complaint, std::forward<Values>(values)...));
}

std::vector<double> numbers_of(std::string_view text, const std::string& path, int line) {
  std::vector<double> numbers;
  for (const std::string_view word : words_of(text, kSpace, kKittiColumns + 1)) {
    const auto number = number_from<double>(word);
    if (!number || !std::isfinite(*number)) {
      fail(path, line,
           "expected a finite number, found '{}'; give a trajectory in TUM or KITTI form",
           excerpt(word));
    }
    numbers.push_back(*number);
  }
  return numbers;
}

Form form_of(const Row& row, const std::string& path) {
  const std::size_t columns = row.numbers.size();
  if (columns == kTumColumns) return Form::kTum;
  if (columns == kKittiColumns) return Form::kKitti;
  fail(
      path, row.line,
      "expected 8 numbers (TUM) or 12 (KITTI), found {}; give a trajectory in one of the two forms",
      columns);
}

void require_columns(const Row& row, std::size_t expected, const std::string& form,
                     const std::string& path) {
  if (row.numbers.size() == expected) return;
  fail(path, row.line, "expected {} numbers ({}), found {}{}; correct or remove the line", expected,
       form, row.numbers.size() > kKittiColumns ? "more than " : "",
       std::min(row.numbers.size(), kKittiColumns));
}

StampedPose tum_pose(const Row& row, const Trajectory& before, const std::string& path) {
  require_columns(row, kTumColumns, "TUM: stamp x y z qx qy qz qw", path);
  const auto& n = row.numbers;
  const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
  if (!(std::abs(q.norm() - 1.0) <= kRotationTolerance)) {
    fail(path, row.line, "expected a unit quaternion in columns 5 to 8, found one of norm {:.4g}",
         q.norm());
  }
  if (!before.empty() && !(n[0] > before.back().stamp_s)) {
    fail(path, row.line,
         "expected stamps that rise from line to line, found {:.9f} after {:.9f}; sort the lines "
         "and remove repeated ones",
         n[0], before.back().stamp_s);
  }
  StampedPose pose;
  pose.stamp_s = n[0];
  pose.T_map_sensor.linear() = q.normalized().toRotationMatrix();
  pose.T_map_sensor.translation() = Eigen::Vector3d(n[1], n[2], n[3]);
  return pose;
}

StampedPose kitti_pose(const Row& row, double stamp_s, const std::string& path) {
  require_columns(row, kKittiColumns, "KITTI: a 3x4 pose, row by row", path);
  const Eigen::Matrix<double, 3, 4> matrix =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(row.numbers.data());
  const Eigen::Matrix3d R = matrix.leftCols<3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= kRotationTolerance) || R.determinant() < 0.0) {
    fail(path, row.line,
         "expected a rotation in columns 1-3, 5-7, 9-11, found a matrix with |R'R - I| = {:.4g} "
         "and determinant {:.4g}",
         deviation, R.determinant());
  }
  StampedPose pose;
  pose.stamp_s = stamp_s;
  pose.T_map_sensor.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  pose.T_map_sensor.translation() = matrix.col(3);
  return pose;
}

/// The poses of a file, each made from its line as it is met: '#' comments and empty lines are left
/// out. Without a form the first line of numbers determines it.
TrajectoryFile parsed(const std::string& path, std::optional<Form> form, double period_s) {
  const std::string file = whole_file(path, "a trajectory", kMaxTrajectoryFileBytes);
  Trajectory trajectory;
  std::string_view rest = file;
  for (int line = 1; !rest.empty(); ++line) {
    const std::string_view text = next_line(rest);
    const Row row{line, numbers_of(text.substr(0, text.find('#')), path, line)};
    if (row.numbers.empty()) continue;
    if (!form) form = form_of(row, path);
    trajectory.push_back(
        form == Form::kTum
            ? tum_pose(row, trajectory, path)
            : kitti_pose(row, static_cast<double>(trajectory.size()) * period_s, path));
  }
  if (trajectory.empty()) {
    throw Error(
        "{}: expected at least one pose, found none; give a trajectory in TUM or KITTI form", path);
  }
  return {path, std::move(trajectory), form == Form::kTum};
}

void write_lines(const Trajectory& trajectory, const std::string& path,
                 const std::function<std::string(const StampedPose&)>& line_of) {
  std::string lines;
  for (const StampedPose& pose : trajectory) lines += line_of(pose);
  write_whole_file(path, lines);
}

}  // namespace

double path_length_m(const Trajectory& trajectory) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length_m +=
        (trajectory[i].T_map_sensor.translation() - trajectory[i - 1].T_map_sensor.translation())
            .norm();
  }
  return length_m;
}

std::string tum_line(const StampedPose& pose) {
  const Eigen::Vector3d& t = pose.T_map_sensor.translation();
  Eigen::Quaterniond q(pose.T_map_sensor.linear());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();  // one text per pose, whichever sign Eigen picked
  return fmt::format("{:.9f} {:.9f} {:.9f} {:.9f} {:.12f} {:.12f} {:.12f} {:.12f}\n", pose.stamp_s,
                     t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string kitti_line(const StampedPose& pose) {
  std::string line;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      line += fmt::format("{:.12e}{}", pose.T_map_sensor.matrix()(row, column),
                          row == 2 && column == 3 ? '\n' : ' ');
    }
  }
  return line;
}

Trajectory read_tum(const std::string& path) { return parsed(path, Form::kTum, 0.0).poses; }

Trajectory read_kitti_poses(const std::string& path, double period_s) {
  return parsed(path, Form::kKitti, period_s).poses;
}

TrajectoryFile read_trajectory_file(const std::string& path, double period_s) {
  return parsed(path, std::nullopt, period_s);
}

void write_tum(const Trajectory& trajectory, const std::string& path) {
  write_lines(trajectory, path, tum_line);
}

void write_kitti_poses(const Trajectory& trajectory, const std::string& path) {
  write_lines(trajectory, path, kitti_line);
}

}  // namespace hqslam
