#pragma once

#include "map/mapping.h"
#include "slam/yard.h"

namespace hqslam::test {

/// Few columns, for speed: what streets are driven with, and how.
inline SensorModel street_sensor() { return small_sensor(16, 360); }
inline constexpr double kStreetStep_m = 1.0;

/// Flat ground with upright boxes: houses, walls, posts, as many and as irregular as are wanted.
struct Village {
  std::vector<Box> boxes;

  enum class Along { kX, kY };

  /// Both sides of a street that begins at (x, y): houses of every size, posts before them.
  void add_street(double x_m, double y_m, double length_m, unsigned seed, Along along = Along::kX) {
    std::mt19937 generator(seed);
    const auto random = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(generator() % 10001) / 10000.0;
    };
    // `at` and `end` along the street, distances across it.
    const auto add = [&](double at_m, double end_m, double near_m, double far_m, double height_m) {
      const Eigen::Vector2d a_m(at_m, near_m);
      const Eigen::Vector2d b_m(end_m, far_m);
      const Eigen::Vector2d begin_m(x_m, y_m);
      if (along == Along::kX) add_box(begin_m + a_m, begin_m + b_m, height_m);
      if (along == Along::kY) add_box(begin_m + a_m.reverse(), begin_m + b_m.reverse(), height_m);
    };
    for (const double side : {-1.0, 1.0}) {
      double at_m = random(0.0, 3.0);
      while (at_m < length_m - 4.0) {
        const double end_m = std::min(at_m + random(4.0, 12.0), length_m);
        const double front_m = side * random(6.0, 10.0);
        const double back_m = front_m + side * random(4.0, 9.0);
        add(at_m, end_m, front_m, back_m, random(3.0, 9.0));
        const double post_m = random(at_m, end_m);
        add(post_m, post_m + 0.3, side * 4.5, side * 4.8, 6.0);
        at_m = end_m + random(0.5, 6.0);
      }
    }
  }

  void add_box(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m, double height_m) {
    const Eigen::Vector2d low_m = a_m.cwiseMin(b_m);
    const Eigen::Vector2d high_m = a_m.cwiseMax(b_m);
    boxes.push_back({{low_m.x(), low_m.y(), 0.0}, {high_m.x(), high_m.y(), height_m}});
  }

  OrganizedCloud scan(const Pose& T_village_sensor) const {
    return scan(street_sensor(), T_village_sensor);
  }
  /// The scan of a standing sensor, up to 60 m.
  OrganizedCloud scan(const SensorModel& sensor, const Pose& T_village_sensor) const {
    constexpr double kReach_m = 60.0;
    const Eigen::Vector3d origin_m = T_village_sensor.translation();
    std::vector<Box> near;
    for (const Box& box : boxes) {
      const Eigen::Vector3d nearest_m = origin_m.cwiseMax(box.low_m).cwiseMin(box.high_m);
      if ((nearest_m - origin_m).norm() < kReach_m) near.push_back(box);
    }
    const RangeImage image = made_image(sensor, [&](int, int, const Eigen::Vector3d& direction) {
      const double range_m = cast(near, origin_m, T_village_sensor.linear() * direction);
      return range_m < kReach_m ? range_m : 0.0;
    });
    return unproject(image, sensor, CaptureTime::kMotionCorrected);
  }

 private:
  static double cast(const std::vector<Box>& near, const Eigen::Vector3d& origin_m,
                     const Eigen::Vector3d& direction) {
    double nearest_m = direction.z() < 0.0 ? -origin_m.z() / direction.z() : HUGE_VAL;
    for (const Box& box : near) nearest_m = std::min(nearest_m, box.entered_m(origin_m, direction));
    return nearest_m;
  }
};

/// One straight street along x.
inline Village street(unsigned seed, double begin_m = -40.0, double length_m = 160.0) {
  Village village;
  village.add_street(begin_m, 0.0, length_m, seed);
  return village;
}

/// Identical houses from x = -20 to 40 m and from 40 to 100 m.
inline Village street_of_two_equal_halves() {
  Village village;
  village.add_street(-20.0, 0.0, 60.0, 31);
  village.add_street(40.0, 0.0, 60.0, 31);
  return village;
}

/// A village and a path through it.
struct Circuit {
  Village village;
  std::vector<Pose> T_village_sensor;
};

/// From corner to corner, which are right angles, rounded with 6 m; a pose about every step_m.
inline std::vector<Pose> path_through(const std::vector<Eigen::Vector2d>& corners_m,
                                      double step_m) {
  constexpr double kRadius_m = 6.0;
  std::vector<Pose> path;
  const auto add = [&](const Eigen::Vector2d& p_m, const Eigen::Vector2d& heading) {
    path.push_back(
        pose_from_xyz_rpy({p_m.x(), p_m.y(), 1.7}, 0.0, 0.0, std::atan2(heading.y(), heading.x())));
  };
  for (std::size_t i = 0; i + 1 < corners_m.size(); ++i) {
    const Eigen::Vector2d ahead = (corners_m[i + 1] - corners_m[i]).normalized();
    const bool first = i == 0;
    const bool last = i + 2 == corners_m.size();
    const double end_m = (corners_m[i + 1] - corners_m[i]).norm() - (last ? 0.0 : kRadius_m);
    for (double at_m = first ? 0.0 : kRadius_m; at_m < end_m; at_m += step_m) {
      add(corners_m[i] + at_m * ahead, ahead);
    }
    if (last) break;
    const Eigen::Vector2d aside = (corners_m[i + 2] - corners_m[i + 1]).normalized();
    const Eigen::Vector2d centre_m = corners_m[i + 1] + kRadius_m * (aside - ahead);
    for (double turn_rad = 0.0; turn_rad < M_PI / 2; turn_rad += step_m / kRadius_m) {
      const double sine = std::sin(turn_rad);
      const double cosine = std::cos(turn_rad);
      add(centre_m + kRadius_m * (sine * ahead - cosine * aside), cosine * ahead + sine * aside);
    }
  }
  return path;
}

/// Once around a block of 90 x 60 m, and 70 m more.
inline Circuit circuit() {
  Circuit result{{}, path_through({{0, 0}, {90, 0}, {90, 60}, {0, 60}, {0, 0}, {70, 0}}, 1.5)};
  result.village.add_street(14.0, 0.0, 62.0, 11);
  result.village.add_street(14.0, 60.0, 62.0, 12);
  result.village.add_street(0.0, 14.0, 32.0, 13, Village::Along::kY);
  result.village.add_street(90.0, 14.0, 32.0, 14, Village::Along::kY);
  return result;
}

/// How far the end of a path around a circuit is from where it was passed first, beyond what is
/// true.
inline double closing_error_m(const std::vector<Pose>& estimate, const std::vector<Pose>& truth) {
  const std::size_t last = truth.size() - 1;
  const auto distance_m = [&](const Pose& pose) {
    return (pose.translation() - truth[last].translation()).norm();
  };
  const auto middle = truth.begin() + static_cast<std::ptrdiff_t>(last / 2);
  const auto nearest = std::min_element(truth.begin(), middle, [&](const Pose& a, const Pose& b) {
    return distance_m(a) < distance_m(b);
  });
  const auto first = static_cast<std::size_t>(nearest - truth.begin());
  const Pose T_true = truth[first].inverse() * truth[last];
  const Pose T_estimated = estimate[first].inverse() * estimate[last];
  return (T_estimated.translation() - T_true.translation()).norm();
}

/// What the front end finds in a scan, and the same as mapping takes it.
inline slam::Features scan_features(const OrganizedCloud& cloud, const SensorModel& sensor) {
  return slam::extract_features(cloud, slam::segment(cloud, sensor), sensor.measured_rows);
}
inline slam::MapFeatures features_of(const OrganizedCloud& cloud, const SensorModel& sensor) {
  return slam::map_features(scan_features(cloud, sensor), {});
}

}  // namespace hqslam::test
