#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "hqslam/core/error.h"
#include "hqslam/core/npz.h"
#include "hqslam/slam/saved_map.h"

namespace hqslam::slam {

namespace {

constexpr const char* kFormat = "hqslam map 1";
constexpr std::int64_t kLargestBytes = 4LL << 30;
constexpr double kFarthest_m = 1e6;
constexpr double kRotationTolerance = 1e-6;
constexpr std::int64_t kContextSize = std::int64_t{ScanContext::kRings} * ScanContext::kSectors;

using Shape = std::vector<std::int64_t>;

NpzArray array_of(const std::vector<Eigen::Vector3f>& points_m) {
  std::vector<float> values;
  values.reserve(3 * points_m.size());
  for (const Eigen::Vector3f& point_m : points_m) {
    values.insert(values.end(), point_m.data(), point_m.data() + 3);
  }
  return npz_array(values, {static_cast<std::int64_t>(points_m.size()), 3});
}

/// The arrays of a map's file by their names.
class MapFile {
 public:
  explicit MapFile(const std::string& path) : path_(path), arrays_(read_npz(path, kLargestBytes)) {
    if (!arrays_.contains("format") ||
        text_value(arrays_.at("format"), path + ": format") != kFormat) {
      refuse("expected a map saved by hqslam run --save-map, found another archive");
    }
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error("{}: {}; save the map again", path_, what);
  }

  /// An array of `rows` x the rest of a shape, any number of rows.
  const NpzArray& at(const std::string& name, const Shape& row_shape) const {
    const auto found = arrays_.find(name);
    if (found == arrays_.end()) refuse(fmt::format("expected an array {}, found none", name));
    const Shape& shape = found->second.shape;
    if (shape.size() != row_shape.size() + 1 ||
        !std::equal(row_shape.begin(), row_shape.end(), shape.begin() + 1)) {
      refuse(fmt::format("array {}: expected rows of {}, found another shape", name,
                         fmt::join(row_shape, " x ")));
    }
    return found->second;
  }

  template <typename Value>
  void require_finite(const std::vector<Value>& values, const std::string& name) const {
    for (const Value value : values) {
      if (!std::isfinite(value)) {
        refuse(fmt::format("array {}: expected finite numbers, found {}", name, value));
      }
    }
  }

  /// Coordinates beyond kFarthest_m are outside of every map.
  template <typename Value>
  void require_within_reach(const std::vector<Value>& values, const std::string& name) const {
    require_finite(values, name);
    for (const Value value : values) {
      if (!(std::abs(value) <= kFarthest_m)) {
        refuse(fmt::format("array {}: expected coordinates up to {} m, found {} m", name,
                           kFarthest_m, value));
      }
    }
  }

  std::vector<Eigen::Vector3f> points_m(const std::string& name) const {
    const std::vector<float> values = float_values(at(name, {3}), path_ + ": " + name);
    require_within_reach(values, name);
    std::vector<Eigen::Vector3f> points(values.size() / 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = Eigen::Vector3f::Map(&values[3 * i]);
    }
    return points;
  }

  /// The intensities of an array of points; empty for recordings without.
  std::vector<float> intensity(const std::string& name, std::size_t points) const {
    if (!arrays_.contains(name)) return {};
    std::vector<float> values = float_values(at(name, {}), path_ + ": " + name);
    if (values.size() != points) {
      refuse(fmt::format("array {}: expected one number for each of {} points, found {}", name,
                         points, values.size()));
    }
    return values;
  }

  double close_ratio() const {
    constexpr const char* kName = "close_ratio";
    if (!arrays_.contains(kName)) return 0.0;
    const std::vector<double> values = double_values(at(kName, {}), path_ + ": " + kName);
    if (values.size() != 1) {
      refuse(fmt::format("array {}: expected one number, found {}", kName, values.size()));
    }
    if (!(values.front() > 0.0 && values.front() <= 1.0)) {
      refuse(fmt::format("array {}: expected a share of 1, found {}", kName, values.front()));
    }
    return values.front();
  }

  std::vector<SavedPlace> places() const {
    const std::vector<double> poses =
        double_values(at("T_map_place", {3, 4}), path_ + ": T_map_place");
    const std::vector<float> contexts =
        float_values(at("place_contexts", {ScanContext::kRings, ScanContext::kSectors}),
                     path_ + ": place_contexts");
    require_within_reach(poses, "T_map_place");
    require_finite(contexts, "place_contexts");
    const std::size_t count = poses.size() / 12;
    if (contexts.size() != count * kContextSize) {
      refuse(fmt::format("expected a context for each of {} places, found {}", count,
                         contexts.size() / kContextSize));
    }
    std::vector<SavedPlace> result(count);
    for (std::size_t i = 0; i < count; ++i) {
      result[i] = {pose(&poses[12 * i]), context(&contexts[i * kContextSize])};
    }
    return result;
  }

 private:
  Pose pose(const double* rows) const {
    Pose result = Pose::Identity();
    result.matrix().topRows<3>() = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>::Map(rows);
    const Eigen::Matrix3d rotation = result.linear();
    if (!(rotation * rotation.transpose()).isIdentity(kRotationTolerance) ||
        rotation.determinant() < 0.0) {
      refuse("array T_map_place: expected rotations, found another matrix");
    }
    return result;
  }

  static ScanContext context(const float* rows) {
    ScanContext result;
    result.unit_sectors =
        Eigen::Matrix<float, ScanContext::kRings, ScanContext::kSectors, Eigen::RowMajor>::Map(
            rows);
    for (int sector = 0; sector < ScanContext::kSectors; ++sector) {
      result.has_returns[sector] = result.unit_sectors.col(sector).norm() > 0.0F;
    }
    return result;
  }

  std::string path_;
  NpzArrays arrays_;
};

}  // namespace

void write_saved_map(const std::string& path, const SavedMap& map) {
  std::vector<double> poses;
  std::vector<float> contexts;
  for (const SavedPlace& place : map.places) {
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> pose =
        place.T_map_sensor.matrix().topRows<3>();
    poses.insert(poses.end(), pose.data(), pose.data() + pose.size());
    const Eigen::Matrix<float, ScanContext::kRings, ScanContext::kSectors, Eigen::RowMajor>
        context = place.context.unit_sectors;
    contexts.insert(contexts.end(), context.data(), context.data() + context.size());
  }
  const auto places = static_cast<std::int64_t>(map.places.size());
  NpzArrays arrays = {{"format", npz_text(kFormat)},
                      {"edges_m", array_of(map.edges_m)},
                      {"posts_m", array_of(map.posts_m)},
                      {"planes_m", array_of(map.planes_m)},
                      {"T_map_place", npz_array(poses, {places, 3, 4})},
                      {"place_contexts",
                       npz_array(contexts, {places, ScanContext::kRings, ScanContext::kSectors})}};
  const auto add_intensity = [&](const char* name, const std::vector<float>& intensity) {
    const auto points = static_cast<std::int64_t>(intensity.size());
    if (points > 0) arrays.emplace(name, npz_array(intensity, {points}));
  };
  add_intensity("edges_intensity", map.edges_intensity);
  add_intensity("posts_intensity", map.posts_intensity);
  add_intensity("planes_intensity", map.planes_intensity);
  if (map.close_ratio > 0.0) {
    arrays.emplace("close_ratio", npz_array(std::vector{map.close_ratio}, {1}));
  }
  write_npz(path, arrays);
}

SavedMap read_saved_map(const std::string& path) {
  if (!path.ends_with(".npz")) {
    throw Error(
        "{}: expected the saved_map.npz that hqslam run --save-map writes, found a file of another "
        "kind; give that file",
        path);
  }
  const MapFile file(path);
  SavedMap map{file.points_m("edges_m"), file.points_m("posts_m"), file.points_m("planes_m"),
               file.places()};
  map.edges_intensity = file.intensity("edges_intensity", map.edges_m.size());
  map.posts_intensity = file.intensity("posts_intensity", map.posts_m.size());
  map.planes_intensity = file.intensity("planes_intensity", map.planes_m.size());
  map.close_ratio = file.close_ratio();
  return map;
}

}  // namespace hqslam::slam
