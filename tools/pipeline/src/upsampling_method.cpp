#include <fmt/ranges.h>

#include <filesystem>
#include <system_error>

#include "hqslam/core/error.h"
#include "hqslam/nn/interpolation.h"
#include "hqslam/nn/weights_file.h"
#include "hqslam/pipeline/upsampler.h"

namespace hqslam::pipeline {
namespace {

/// The end of the name of weights for every sensor. Others of the same network may have been
/// trained further with scans of one.
constexpr const char* kForAnySensor = "_any-beams.npz";

/// Whether weights made for `full` take scans of `recorded`.
bool takes(const SensorModel& recorded, const SensorModel& full, RowSelection measured_rows) {
  return have_same_beams(recorded, full) ||
         have_same_beams(recorded, select_rows(full, measured_rows));
}

/// The file of the weights of this name that weights_file() chooses.
std::string weights_for(const std::string& name, const std::optional<SensorModel>& recorded,
                        int rows) {
  const std::vector<std::string> files = installed_weights_files(name);
  std::vector<std::string> made_for;
  std::optional<std::string> for_any;
  std::optional<std::string> for_its_beams;
  for (const std::string& file : files) {
    if (file.ends_with(kForAnySensor)) {
      for_any = file;
      continue;
    }
    const nn::NetworkDescription network = nn::read_weights(file).description;
    if (recorded && takes(*recorded, network.sensor, network.measured_rows)) {
      const int measured = nn::measured_row_count(network.sensor.rows(), network.measured_rows);
      const bool has_columns = fits_any_sensor(network) ||
                               recorded->columns >= kFewestColumnsShare * network.sensor.columns;
      if ((recorded->rows() == measured || rows == measured) && has_columns) return file;
      for_its_beams = file;
    }
    made_for.push_back(network.sensor.name);
  }
  if (for_any) return *for_any;
  if (for_its_beams) return *for_its_beams;
  if (!recorded) {
    throw Error(
        "{}: expected a recording whose sensor is known, to choose between weights for {}; name "
        "the sensor or give a weights file",
        name, fmt::join(made_for, ", "));
  }
  throw Error(
      "{}: there are weights for {}, none for '{}'; give a weights file that was made for it", name,
      fmt::join(made_for, ", "), recorded->name);
}

}  // namespace

bool is_weights_name(const std::string& method) {
  std::error_code error;
  return !method.empty() && !std::filesystem::is_regular_file(method, error) &&
         !installed_weights_files(method).empty();
}

std::string weights_file(const std::string& method, const std::optional<SensorModel>& recorded,
                         int rows) {
  return is_weights_name(method) ? weights_for(method, recorded, rows) : method;
}

UpsamplingMethod load_method(const UpsamplingOptions& options,
                             const std::optional<SensorModel>& recorded) {
  const std::string& method = options.method;
  if (method.empty()) return std::monostate();
  if (nn::is_interpolation(method)) return nn::interpolation_from_name(method);
  return nn::SuperResolver::load(weights_file(method, recorded, options.rows), options.network);
}

std::optional<SensorModel> sensor_of(const UpsamplingMethod& method) {
  const auto* network = std::get_if<nn::SuperResolver>(&method);
  if (network == nullptr || nn::fits_any_sensor(network->description())) return std::nullopt;
  SensorModel sensor = network->sensor();
  sensor.measured_rows = network->description().measured_rows;
  return sensor;
}

}  // namespace hqslam::pipeline
