#include "scan/column_finder.h"

#include "made_images.h"

namespace hqslam {
namespace {

int by_definition(const SensorModel& sensor, int row, const Eigen::Vector3f& point_m) {
  return sensor.column_of(row, std::atan2(point_m.y(), point_m.x()));
}

}  // namespace

TEST_CASE("the column that is found quickly is the sensor's own, also at all columns' edges") {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> coordinate_m(-80.0F, 80.0F);
  std::vector<SensorModel> sensors;
  for (const std::string& name : sensor_preset_names()) sensors.push_back(sensor_preset(name));
  for (const int columns : {16, 1023, 16384}) {
    sensors.push_back(preset_with("vls-128", columns));
  }
  for (const SensorModel& sensor : sensors) {
    CAPTURE(sensor.name);
    CAPTURE(sensor.columns);
    const ColumnFinder finder(sensor);
    int different = 0;
    for (int i = 0; i < 100'000; ++i) {
      const int row = static_cast<int>(random() % static_cast<unsigned>(sensor.rows()));
      const Eigen::Vector3f point_m(coordinate_m(random), coordinate_m(random), 0.0F);
      if (finder.column(row, point_m) != by_definition(sensor, row, point_m)) ++different;
    }
    CHECK(different == 0);
    for (int column = 0; column < sensor.columns; ++column) {
      const int row = column % sensor.rows();
      const double edge_rad = sensor.azimuth_rad(row, column) + 0.5 * sensor.column_step_rad();
      for (const int units : {-3, -1, 0, 1, 3}) {  // of the last place beside the left edge
        Eigen::Vector3f point_m = (20.0 * direction_of(edge_rad, 0.0)).cast<float>();
        const float towards = units < 0 ? -1e9F : 1e9F;
        for (int i = 0; i < std::abs(units); ++i) {
          point_m.y() = std::nextafter(point_m.y(), towards);
        }
        if (finder.column(row, point_m) != by_definition(sensor, row, point_m)) ++different;
      }
    }
    CHECK(different == 0);
  }
}

TEST_CASE("points on the axes, on diagonals, at the origin and beyond all bounds have a column") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr float kSmallest = std::numeric_limits<float>::denorm_min();
  const SensorModel sensor = sensor_preset("os1-64");
  const ColumnFinder finder(sensor);
  for (const float x : {0.0F, -0.0F, 1.0F, -1.0F, kSmallest, kLargest, -kLargest, kInfinity}) {
    for (const float y : {0.0F, -0.0F, 1.0F, -1.0F, -kSmallest, kLargest, -kLargest, -kInfinity}) {
      for (int row = 0; row < sensor.rows(); ++row) {
        const Eigen::Vector3f point_m(x, y, 1.0F);
        CHECK(finder.column(row, point_m) == by_definition(sensor, row, point_m));
      }
    }
  }
}

}  // namespace hqslam
