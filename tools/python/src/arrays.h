#pragma once

#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/trajectory.h"
#include "others_go_on.h"

namespace nb = nanobind;

NB_MAKE_OPAQUE(hqslam::Trajectory)  // a class of its own, no list

namespace hqslam::python {

/// What goes out: a numpy array that looks at memory of ours.
template <typename T, nb::ssize_t... Shape>
using Array = nb::ndarray<nb::numpy, T, nb::shape<Shape...>>;
using Image = Array<float, -1, -1>;         ///< rows x columns
using PointGrid = Array<float, -1, -1, 3>;  ///< rows x columns x 3
using PointList = Array<float, -1, 3>;      ///< N x 3
using PoseList = Array<double, -1, 4, 4>;   ///< N x 4 x 4
using ImuList = Array<double, -1, 7>;       ///< N ImuSamples
static_assert(sizeof(ImuSample) == 7 * sizeof(double));

/// What comes in: any array of the shape; copied only where it has another type or is not in C
/// order.
template <typename T, nb::ssize_t... Shape>
using Input = nb::ndarray<const T, nb::shape<Shape...>, nb::c_contig, nb::device::cpu>;

template <typename T, typename Given>
std::vector<T> values_of(const Given& array) {
  const auto* first = reinterpret_cast<const T*>(array.data());
  return {first, first + array.size() * sizeof(*array.data()) / sizeof(T)};
}
/// Nothing gives an empty vector.
template <typename T, typename Given>
std::vector<T> values_of(const std::optional<Given>& array) {
  return array ? values_of<T>(*array) : std::vector<T>();
}

/// An array of one dimension that owns what it shows: moved, not copied.
template <typename Shown, typename T>
Shown owned(std::vector<T> values, std::initializer_list<std::size_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  using Scalar = typename Shown::Scalar;
  auto* data = reinterpret_cast<Scalar*>(kept->data());
  nb::capsule owner(kept.get(),
                    [](void* vector) noexcept { delete static_cast<std::vector<T>*>(vector); });
  kept.release();
  return Shown(data, shape, owner);
}
/// Policy of a property that returns such an array; other arrays are views of their object.
inline constexpr auto kOwned = nb::rv_policy::reference;

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
inline Matrix4 matrix_of(const Pose& pose) { return pose.matrix(); }
/// Throws Error unless it is a rigid transform.
Pose pose_of(const Matrix4& matrix);
PoseList pose_list(const std::vector<Pose>& poses);

/// An object that serves one thread at a time. While it works other threads of Python go on, and
/// those that call it wait for their turn.
template <typename T>
class Guarded {
 public:
  explicit Guarded(T object) : object_(std::move(object)) {}

  template <typename Work>
  auto call(const Work& work) {
    const OthersGoOn others_go_on;
    const std::scoped_lock one_at_a_time(mutex_);
    return work(object_);
  }

 private:
  T object_;
  std::mutex mutex_;
};

/// One method of it without arguments: its result, not a reference to it.
template <auto Method, typename T>
auto ask(Guarded<T>& object) {
  return object.call([](T& inner) { return (inner.*Method)(); });
}

}  // namespace hqslam::python
