#pragma once

#include <filesystem>
#include <string>

#include "files/output_guard.h"
#include "hqslam/evaluation/png.h"
#include "run/dense_map_run.h"

namespace hqslam::tools {

/// A dense map as people look at it.
struct DenseMapPictures {
  RgbImage above;
  RgbImage perspective;
};
/// path: of the sensor, in the map's frame.
DenseMapPictures pictures_of(const DenseMapRun& run, const Trajectory& path);

/// dense_map.pcd, dense_map.ply, dense_map_above.png, dense_map_perspective.png
inline constexpr const char* kDenseMapFiles[] = {
    "dense_map.pcd", "dense_map.ply", "dense_map_above.png", "dense_map_perspective.png"};

/// Throws Error if one of the files is there and was not written by hqslam, or is one of `inputs`.
void guard_dense_map(const std::filesystem::path& folder, const Paths& inputs);
/// Removes those of an earlier map.
void remove_dense_map(const std::filesystem::path& folder);
/// Writes each file under another name first and renames it then, so that each is whole whenever
/// the program stops; makes the folder. Throws Error, leaving no half of a file.
void write_dense_map(const DenseMapRun& run, const DenseMapPictures& pictures,
                     const std::filesystem::path& folder);

}  // namespace hqslam::tools
