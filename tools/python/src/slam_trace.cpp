#include "slam_trace.h"

#include <nanobind/stl/string.h>

#include <cstdint>
#include <string>
#include <type_traits>

namespace hqslam::python {
namespace {

using slam::TracedFeature;

/// Each field of all features, at its offset.
class FeatureArrays {
 public:
  explicit FeatureArrays(TraceArrays<slam::ScanTrace>& shown) : shown_(shown) {}

  template <typename T>
  void show(const char* name, const T* first) {
    shown_.show(name, first, {features()}, {stride<T>()});
  }
  void show(const char* name, const Eigen::Vector3f* first) {
    shown_.show(name, first->data(), {features(), 3}, {stride<float>(), 1});
  }

 private:
  std::size_t features() const { return shown_.trace().features.size(); }
  template <typename T>
  static constexpr std::int64_t stride() {
    static_assert(sizeof(TracedFeature) % sizeof(T) == 0);
    return sizeof(TracedFeature) / sizeof(T);
  }
  TraceArrays<slam::ScanTrace>& shown_;
};

void show_features(TraceArrays<slam::ScanTrace>& shown) {
  static const TracedFeature none;
  const auto& features = shown.trace().features;
  const TracedFeature& first = features.empty() ? none : features.front();
  FeatureArrays arrays(shown);
  arrays.show("features.kind",
              reinterpret_cast<const std::underlying_type_t<slam::FeatureKind>*>(&first.kind));
  arrays.show("features.row", &first.row);
  arrays.show("features.column", &first.column);
  arrays.show("features.point_m", &first.point_m);
  arrays.show("features.is_matched", &first.is_matched);
  arrays.show("features.on_map_m", &first.on_map_m);
  arrays.show("features.residual_m", &first.residual_m);
  arrays.show("features.weight_per_m", &first.weight_per_m);
}

}  // namespace

void show_slam_trace(slam::ScanTrace trace, nb::dict arrays) {
  TraceArrays<slam::ScanTrace> shown(std::move(trace), std::move(arrays));
  const slam::ScanTrace& t = shown.trace();
  const auto rows = static_cast<std::size_t>(t.cloud.rows);
  const auto columns = static_cast<std::size_t>(t.cloud.columns);
  shown.show("cloud.points_m", reinterpret_cast<const float*>(t.cloud.points_m.data()),
             {rows, columns, 3});
  shown.show("cloud.range_m", t.cloud.range_m.data(), {rows, columns});
  shown.show("pixel_class", reinterpret_cast<const std::uint8_t*>(t.pixel_class.data()),
             {rows, columns});
  shown.set("state_before", nb::cast(std::string(t.state_before)));
  shown.set("state", nb::cast(std::string(t.state)));
  shown.set("T_map_expected", nb::cast(matrix_of(t.T_map_expected)));
  shown.set("T_map_odometry", nb::cast(matrix_of(t.T_map_odometry)));
  shown.set("T_map_level", nb::cast(matrix_of(t.T_map_level)));
  shown.set("inlier_ratio", nb::cast(t.inlier_ratio));
  shown.set("direction_share", nb::cast(t.direction_share));
  shown.set("direction", nb::cast(Matrix6(t.direction)));
  shown.set("degenerate_directions", nb::cast(t.degenerate_directions));
  show_features(shown);
}

}  // namespace hqslam::python
