#include "hqslam/nn/scan_memory.h"

#include <nanobind/stl/optional.h>

#include "hqslam/core/error.h"
#include "parts.h"
#include "scans.h"

namespace hqslam::python {
namespace {

using Memory = Guarded<nn::ScanMemory>;
using PosesInput = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

nn::ColumnPoses column_poses(const PosesInput& T_world_sensor) {
  const std::size_t axes = T_world_sensor.ndim();
  if (axes < 2 || axes > 3 || T_world_sensor.shape(axes - 2) != 4 ||
      T_world_sensor.shape(axes - 1) != 4) {
    throw Error("T_world_sensor: expected the shape (4, 4) or (columns, 4, 4)");
  }
  nn::ColumnPoses poses;
  for (std::size_t i = 0; i < T_world_sensor.size(); i += 16) {
    poses.push_back(pose_of(Eigen::Map<const Matrix4>(T_world_sensor.data() + i)));
  }
  return poses;
}

}  // namespace

void add_scan_memory(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<nn::RecalledImage>(
      module, "RecalledImage",
      "What other scans measured, earlier ones and with look_ahead later ones, seen from one.")
      .def_prop_ro(
          "range_m",
          [](nn::RecalledImage& r) { return view(r.image.range_m, r.image.rows, r.image.columns); },
          "(rows, columns) float32, metres; 0 where nothing is remembered.")
      .def_prop_ro(
          "weight",
          [](nn::RecalledImage& r) { return view(r.weight, r.image.rows, r.image.columns); },
          "(rows, columns) float32: how many points agree, by how near they pass.");

  nb::class_<Memory>(module, "ScanMemory",
                     "The measured points of the last scans, for weights with a memory. "
                     "T_world_sensor: (columns, 4, 4) float64, metres, where the sensor was at "
                     "each column of the image, or (4, 4) for all of a motion-corrected scan; in "
                     "any frame that stays.")
      .def(
          "__init__",
          [](Memory* self, const SensorModel& sensor, bool look_ahead) {
            new (self) Memory(nn::ScanMemory(
                sensor, look_ahead ? nn::kLookAheadMemory : nn::ScanMemoryOptions{}));
          },
          "sensor"_a, "look_ahead"_a = false,
          "sensor: Upsampler.sensor. look_ahead: the 20 scans after one are remembered before it "
          "recalls. Raises Error.")
      .def(
          "recall",
          [](Memory& memory, const ImageInput& range_m, const PosesInput& T_world_sensor,
             std::optional<double> itself_s) {
            const RangeImage measured = image_of(range_m);
            const nn::ColumnPoses poses = column_poses(T_world_sensor);
            return memory.call([&](auto& m) { return m.recall(measured, poses, itself_s); });
          },
          "range_m"_a, "T_world_sensor"_a, "itself_s"_a = nb::none(),
          "What is remembered, as Upsampler takes it, seen from a scan of which range_m, "
          "(measured rows, columns), metres, shows what has moved since. itself_s: its stamp, "
          "where it is remembered already; it does not recall itself. Raises Error.")
      .def(
          "insert",
          [](Memory& memory, const OrganizedCloud& measured, const PosesInput& T_world_sensor,
             double stamp_s) {
            const nn::ColumnPoses poses = column_poses(T_world_sensor);
            memory.call([&](auto& m) { m.insert(measured, poses, stamp_s); });
          },
          "measured"_a, "T_world_sensor"_a, "stamp_s"_a,
          "Remembers the measured rows of a scan. stamp_s: seconds. Raises Error.")
      .def(
          "clear", [](Memory& memory) { memory.call([](auto& m) { m.clear(); }); },
          "Forgets all: the sensor was carried elsewhere, or its frame has changed.");
}

}  // namespace hqslam::python
