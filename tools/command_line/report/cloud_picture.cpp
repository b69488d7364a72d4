#include "report/cloud_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "hqslam/core/median.h"

namespace hqslam::tools {
namespace {

constexpr Rgb kBackground = {17, 20, 28};
/// From low to high: told apart by lightness too.
constexpr std::array<Rgb, 5> kHeights = {
    {{58, 76, 150}, {42, 132, 152}, {86, 178, 118}, {214, 200, 92}, {246, 236, 206}}};
constexpr float kNothing = std::numeric_limits<float>::infinity();

/// A point as the picture has it: pixels from the left and the top, and how far away it is.
struct Spot {
  double column = 0.0;
  double row = 0.0;
  double side = 1.0;  ///< pixels
  float depth_m = 0.0F;
  Rgb color{};
};

/// An image in which the nearest spot of a pixel is seen.
class DepthImage {
 public:
  DepthImage(int rows, int columns) : depth_m_(static_cast<std::size_t>(rows) * columns, kNothing) {
    image_.rows = rows;
    image_.columns = columns;
    image_.pixels.assign(depth_m_.size(), kBackground);
  }

  void draw(const Spot& spot) {
    // Written so that what is not a number fails.
    const double reach = spot.side / 2.0;
    const bool is_inside = spot.column > -reach && spot.column < image_.columns + reach &&
                           spot.row > -reach && spot.row < image_.rows + reach;
    if (!is_inside) return;
    const auto first = [&](double at) { return static_cast<int>(std::floor(at - reach + 0.5)); };
    const auto last = [&](double at) {
      return std::max(first(at), static_cast<int>(std::ceil(at + reach - 0.5)) - 1);
    };
    for (int row = std::max(0, first(spot.row)); row <= std::min(image_.rows - 1, last(spot.row));
         ++row) {
      for (int column = std::max(0, first(spot.column));
           column <= std::min(image_.columns - 1, last(spot.column)); ++column) {
        const std::size_t pixel = static_cast<std::size_t>(row) * image_.columns + column;
        if (spot.depth_m >= depth_m_[pixel]) continue;
        depth_m_[pixel] = spot.depth_m;
        image_.pixels[pixel] = spot.color;
      }
    }
  }

  /// Darkens pixels behind nearer neighbours, so that edges in depth are seen.
  /// Source: Boucheny, "Interactive scientific visualization of large datasets", 2009 (eye-dome
  /// lighting).
  RgbImage shaded() const {
    RgbImage result = image_;
    for (int row = 0; row < image_.rows; ++row) {
      for (int column = 0; column < image_.columns; ++column) {
        const std::size_t pixel = static_cast<std::size_t>(row) * image_.columns + column;
        if (depth_m_[pixel] == kNothing) continue;
        const double light = light_at(row, column);
        for (std::uint8_t& channel : result.pixels[pixel]) {
          channel = static_cast<std::uint8_t>(std::lround(light * channel));
        }
      }
    }
    return result;
  }

 private:
  double light_at(int row, int column) const {
    constexpr int kRadius = 2;
    constexpr double kStrength = 6.0;
    constexpr std::array<std::array<int, 2>, 8> kAround = {
        {{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {0, 1}, {1, -1}, {1, 0}, {1, 1}}};
    const float depth_m = depth_m_[static_cast<std::size_t>(row) * image_.columns + column];
    double behind = 0.0;
    for (const auto& [down, right] : kAround) {
      const int r = row + kRadius * down;
      const int c = column + kRadius * right;
      if (r < 0 || r >= image_.rows || c < 0 || c >= image_.columns) continue;
      const float other_m = depth_m_[static_cast<std::size_t>(r) * image_.columns + c];
      if (other_m < depth_m) behind += std::log(depth_m / other_m);
    }
    return std::max(0.25, std::exp(-kStrength * std::min(behind / 8.0, 1.0)));
  }

  RgbImage image_;
  std::vector<float> depth_m_;
};

Eigen::AlignedBox2d surroundings_of(const Trajectory& path) {
  constexpr double kMargin_m = 40.0;
  Eigen::AlignedBox2d box;
  for (const StampedPose& pose : path) box.extend(pose.T_map_sensor.translation().head<2>());
  if (box.isEmpty()) box.extend(Eigen::Vector2d::Zero());
  box.min().array() -= kMargin_m;
  box.max().array() += kMargin_m;
  return box;
}

/// Behind and above a sensor, upright, looking ahead and down. Axes: x to the right, y down, z into
/// the picture.
Pose T_camera_map_behind(const Pose& T_map_sensor) {
  constexpr double kBehind_m = 16.0;
  constexpr double kAbove_m = 9.0;
  constexpr double kDown = 0.34;  ///< per metre ahead
  const Eigen::Vector2d heading = T_map_sensor.linear().col(0).head<2>().normalized();
  const Eigen::Vector3d ahead(heading.x(), heading.y(), 0.0);
  const Eigen::Vector3d look = (ahead - kDown * Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d right = look.cross(Eigen::Vector3d::UnitZ()).normalized();
  Pose T_map_camera = Pose::Identity();
  T_map_camera.linear() << right, look.cross(right), look;
  T_map_camera.translation() =
      T_map_sensor.translation() - kBehind_m * ahead + kAbove_m * Eigen::Vector3d::UnitZ();
  return T_map_camera.inverse();
}

/// Points per pixel.
std::vector<int> counts_from_above(const std::vector<Eigen::Vector3f>& points_m, const PlotBox& box,
                                   int rows, int columns) {
  std::vector<int> counts(static_cast<std::size_t>(rows) * columns, 0);
  for (const Eigen::Vector3f& point_m : points_m) {
    const double column = to_plot_x(box, point_m.x()) / kPlotUnits * columns;
    const double row = to_plot_y(box, point_m.y()) / kPlotUnits * rows;
    if (row >= 0.0 && row < rows && column >= 0.0 && column < columns) {
      ++counts[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
    }
  }
  return counts;
}

/// A count that few pixels exceed: the darkest grey stands for it.
int dark_count(std::vector<int> counts) {
  std::erase(counts, 0);
  return counts.empty() ? 1 : quantile(counts, 0.99);
}

}  // namespace

std::array<double, 2> range_of(const std::vector<Eigen::Vector3f>& points_m, int axis,
                               double share) {
  std::vector<float> values;
  for (const Eigen::Vector3f& point_m : points_m) {
    if (point_m.allFinite()) values.push_back(point_m[axis]);
  }
  if (values.empty()) return {0.0, 1.0};
  const double low = quantile(values, share);
  return {low, quantile(values, 1.0 - share)};
}

std::array<double, 2> range_of_heights(const std::vector<Eigen::Vector3f>& points_m) {
  const auto [low_m, high_m] = range_of(points_m, 2, 0.01);
  return {low_m, std::max(low_m + 1.0, high_m)};
}

RgbImage cloud_from_above(const CloudScene& scene, int rows, int columns) {
  const Eigen::AlignedBox2d box = surroundings_of(scene.path);
  const double pixels_per_m = std::min(columns / box.sizes().x(), rows / box.sizes().y());
  const auto [low_m, high_m] = range_of_heights(scene.points_m);
  DepthImage image(rows, columns);
  for (const Eigen::Vector3f& point_m : scene.points_m) {
    const Eigen::Vector2d from_centre_m = point_m.head<2>().cast<double>() - box.center();
    Spot spot;
    spot.column = columns / 2.0 + pixels_per_m * from_centre_m.x();
    spot.row = rows / 2.0 - pixels_per_m * from_centre_m.y();
    spot.side = std::max(1.0, pixels_per_m * scene.point_m);
    // Seen from so high that depths hardly differ in ratio.
    spot.depth_m = static_cast<float>(high_m + 60.0 - point_m.z());
    spot.color = color_between(kHeights, (point_m.z() - low_m) / (high_m - low_m));
    image.draw(spot);
  }
  return image.shaded();
}

RgbImage cloud_in_perspective(const CloudScene& scene, int rows, int columns) {
  constexpr double kFocalLength = 0.8;  ///< per width of the picture
  constexpr double kNearest_m = 3.0;
  constexpr double kFarthest_m = 150.0;
  constexpr double kLowest_m = -3.0;
  constexpr double kHighest_m = 9.0;
  DepthImage image(rows, columns);
  if (scene.path.empty()) return image.shaded();
  const Pose& T_map_sensor = scene.path[scene.path.size() / 3].T_map_sensor;
  const Pose T_camera_map = T_camera_map_behind(T_map_sensor);
  const double focal = kFocalLength * columns;
  for (const Eigen::Vector3f& point_m : scene.points_m) {
    const Eigen::Vector3d seen_m = T_camera_map * point_m.cast<double>();
    if (!(seen_m.z() > kNearest_m && seen_m.z() < kFarthest_m)) continue;
    const double height_m = point_m.z() - T_map_sensor.translation().z();
    Spot spot;
    spot.column = columns / 2.0 + focal * seen_m.x() / seen_m.z();
    spot.row = rows / 2.0 + focal * seen_m.y() / seen_m.z();
    spot.side = std::clamp(focal * scene.point_m / seen_m.z(), 1.0, 12.0);
    spot.depth_m = static_cast<float>(seen_m.z());
    spot.color = color_between(kHeights, (height_m - kLowest_m) / (kHighest_m - kLowest_m));
    image.draw(spot);
  }
  return image.shaded();
}

RgbImage density_from_above(const std::vector<Eigen::Vector3f>& points_m, const PlotBox& box,
                            int rows, int columns) {
  constexpr double kLevels = 10.0;
  constexpr double kDarkest = 50.0;
  // A lone point, such as the ground is thinned to, is only hinted at: walls and trees count.
  constexpr double kLonePoint = 0.1;
  const std::vector<int> counts = counts_from_above(points_m, box, rows, columns);
  const double full = std::log(std::max(2, dark_count(counts)));
  RgbImage image;
  image.rows = rows;
  image.columns = columns;
  image.pixels.reserve(counts.size());
  for (const int count : counts) {
    const double tone =
        count == 0 ? 0.0 : kLonePoint + (1.0 - kLonePoint) * std::min(1.0, std::log(count) / full);
    const double share = std::round(kLevels * tone) / kLevels;
    const auto grey = static_cast<std::uint8_t>(255.0 - (255.0 - kDarkest) * share);
    image.pixels.push_back({grey, grey, grey});
  }
  return image;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t present = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8U | (k < present ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= present ? kAlphabet[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace hqslam::tools
