#include <fmt/format.h>

#include <bit>
#include <fstream>

#include "hqslam/core/error.h"
#include "hqslam/slam/dense_map.h"

namespace hqslam::slam {

namespace {

// A point is written as it stands in memory.
static_assert(sizeof(DenseMapPoint) == 20 && std::endian::native == std::endian::little);

void write(const std::string& header, const std::vector<DenseMapPoint>& points,
           const std::string& path) {
  std::ofstream stream(path, std::ios::binary);
  stream << header;
  stream.write(reinterpret_cast<const char*>(points.data()),
               static_cast<std::streamsize>(points.size() * sizeof(DenseMapPoint)));
  stream.close();
  if (!stream) {
    throw Error(
        "{}: cannot be written; check that the folder exists, is writable and has free space",
        path);
  }
}

}  // namespace

void write_dense_map_pcd(const std::vector<DenseMapPoint>& points, const std::string& path) {
  write(fmt::format("# .PCD v0.7 - Point Cloud Data file format\n# written by hqslam\nVERSION 0.7\n"
                    "FIELDS x y z confidence times_seen\nSIZE 4 4 4 4 4\nTYPE F F F F U\n"
                    "COUNT 1 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\n"
                    "DATA binary\n",
                    points.size()),
        points, path);
}

void write_dense_map_ply(const std::vector<DenseMapPoint>& points, const std::string& path) {
  write(fmt::format("ply\nformat binary_little_endian 1.0\n"
                    "comment written by hqslam\ncomment metres\n"
                    "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                    "property float confidence\nproperty uint times_seen\nend_header\n",
                    points.size()),
        points, path);
}

}  // namespace hqslam::slam
