#include <nanobind/stl/string.h>

#include "arrays.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "parts.h"

namespace hqslam::python {
namespace {

using Errors = Array<double, -1>;
Errors view(std::vector<double>& values) { return Errors(values.data(), {values.size()}); }

/// What absolute and relative errors have alike.
template <typename Error>
auto add_errors(nb::module_& module, const char* name, const char* meaning) {
  return nb::class_<Error>(module, name, meaning)
      .def_prop_ro(
          "translation_m", [](Error& e) { return view(e.translation_m); }, "(N,) float64, metres.")
      .def_prop_ro(
          "rotation_rad", [](Error& e) { return view(e.rotation_rad); }, "(N,) float64, radians.")
      .def_ro("translation_statistics", &Error::translation_statistics, "Metres.")
      .def_ro("rotation_statistics", &Error::rotation_statistics, "Radians.");
}

}  // namespace

void add_evaluation(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<Statistics>(module, "ErrorStatistics", "Of errors, in their unit.")
      .def_ro("rmse", &Statistics::rmse, "Root mean square.")
      .def_ro("mean", &Statistics::mean, "Mean.")
      .def_ro("median", &Statistics::median, "Median.")
      .def_ro("max", &Statistics::max, "Largest.");
  add_errors<AbsolutePoseError>(module, "AbsolutePoseError",
                                "Per pair of poses the error after alignment (APE).")
      .def_ro("is_rotation_known", &AbsolutePoseError::is_rotation_known,
              "False: so straight a path leaves the turn about it to errors of positions.")
      .def_ro("aligned_estimate", &AbsolutePoseError::aligned_estimate,
              "The whole estimate, in the reference's frame.");
  add_errors<RelativePoseError>(module, "RelativePoseError",
                                "Per stretch of path the error of its motion (RPE).")
      .def_ro("stretch_m", &RelativePoseError::stretch_m, "Length of a stretch, metres.");
  module.def(
      "absolute_pose_error",
      [](const Trajectory& estimate, const Trajectory& reference, const std::string& alignment,
         double max_difference_s) {
        return absolute_pose_error(estimate, reference, alignment_from_name(alignment),
                                   max_difference_s);
      },
      "estimate"_a, "reference"_a, "alignment"_a = "se3", "max_difference_s"_a = 0.02,
      "alignment: none, first (pose made equal) or se3 (least squares of all positions). "
      "max_difference_s: between the stamps of a pair. Raises Error.");
  module.def("relative_pose_error", &relative_pose_error, "estimate"_a, "reference"_a,
             "stretch_m"_a, "max_difference_s"_a = 0.02,
             "Over stretches of stretch_m metres of path along the reference.");
  nb::class_<Drift>(module, "Drift", "Means over pieces of path, as KITTI's benchmark takes them.")
      .def_ro("pieces", &Drift::pieces, "Of path; 0 where it is shorter than one.")
      .def_ro("translation_percent", &Drift::translation_percent, "Percent of the path.")
      .def_ro("rotation_deg_per_100m", &Drift::rotation_deg_per_100m, "Degrees over 100 m.");
  module.def(
      "drift",
      [](const Trajectory& estimate, const Trajectory& reference, double piece_m,
         double max_difference_s) {
        return drift(relative_pose_error(estimate, reference, piece_m, max_difference_s));
      },
      "estimate"_a, "reference"_a, "piece_m"_a = kDriftPiece_m, "max_difference_s"_a = 0.02,
      "Over pieces of piece_m metres of the reference, from every pose on.");
}

}  // namespace hqslam::python
