#include "hqslam/nn/network_description.h"

#include <cmath>

#include "architecture.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "hqslam/nn/interpolation.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

const Architecture& architecture_of(const NetworkDescription& d) {
  if (d.architecture == nullptr) {
    throw Error("network: a description without an architecture, expected one");
  }
  return *d.architecture;
}

void validate_rows(const NetworkDescription& d) {
  if (d.measured_rows.stride < 1 || d.measured_rows.stride > d.sensor.rows() ||
      d.measured_rows.offset < 0 || d.measured_rows.offset >= d.sensor.rows()) {
    throw Error("network: rows {} + n {} of {} are no selection", d.measured_rows.offset,
                d.measured_rows.stride, d.sensor.rows());
  }
  if (d.measured_rows == RowSelection{0, 1}) {
    throw Error(
        "network: all {} rows of sensor '{}' are measured, expected some to be computed; name the "
        "sensor with all rows, such as os1-64 for 16 measured ones",
        d.sensor.rows(), d.sensor.name);
  }
}

}  // namespace

std::string_view name(const NetworkDescription& d) { return architecture_of(d).name(); }

bool fits_any_sensor(const NetworkDescription& d) {
  return architecture_of(d).for_rows(d.measured_rows) != nullptr;
}

NetworkDescription for_sensor(const NetworkDescription& d, const SensorModel& sensor,
                              RowSelection measured_rows) {
  NetworkDescription result = d;
  result.sensor = sensor;
  result.measured_rows = measured_rows;
  validate_rows(result);
  result.architecture = architecture_of(d).for_rows(measured_rows);
  if (result.architecture == nullptr) {
    throw Error("network: made for {}, expected one for any sensor; take weights for {}",
                d.sensor.name, sensor.name);
  }
  const int measured = measured_row_count(sensor.rows(), measured_rows);
  if (measured % 2 != 0) {
    throw Error("network: expected an even number of measured rows, found {} of {}; interpolate",
                measured, sensor.name);
  }
  validate(result);
  return result;
}

int column_multiple(const NetworkDescription& d) { return architecture_of(d).column_multiple(); }

bool has_confidence(const NetworkDescription& d) { return architecture_of(d).has_confidence(); }

bool has_scan_memory(const NetworkDescription& d) { return architecture_of(d).has_scan_memory(); }

std::optional<OutlierRemovalOptions> last_filter(const NetworkDescription& d) {
  return architecture_of(d).last_filter();
}

void validate(const NetworkDescription& d) {
  const Architecture& architecture = architecture_of(d);
  check_that(d.range_scale_m > 0.0F && std::isfinite(d.range_scale_m), "network", "range_scale_m",
             d.range_scale_m, "above 0");
  check_least_confidence(d);
  check_that(d.confidence_exponent > 0.0F && d.confidence_exponent <= 10.0F, "network",
             "confidence_exponent", d.confidence_exponent, "above 0, at most 10");
  validate(d.sensor);
  validate_rows(d);
  if (const auto filter = architecture.last_filter()) validate(*filter);
  architecture.validate(d);
  check_columns(d, d.sensor.columns);
}

void check_least_confidence(const NetworkDescription& d) {
  check_that(d.least_confidence >= 0.0F && d.least_confidence <= 1.0F, "network",
             "least_confidence", d.least_confidence, "0 to 1");
}

void check_memory(std::int64_t values, const NetworkDescription& d) {
  constexpr std::int64_t kMostValues = std::int64_t{1} << 29U;  // 2 GiB
  if (values > kMostValues) {
    throw Error(
        "network: on images of {} x {} it holds {} values, expected at most {}; take fewer "
        "channels or layers or a sensor with fewer columns",
        d.sensor.rows(), d.sensor.columns, values, kMostValues);
  }
}

void check_columns(const NetworkDescription& d, int columns) {
  const int multiple = column_multiple(d);
  if (columns < 1 || columns > d.sensor.columns || columns % multiple != 0) {
    throw Error("network: images of {} columns, expected 1 to {} and a multiple of {}", columns,
                d.sensor.columns, multiple);
  }
}

std::vector<ParameterShape> parameter_shapes(const NetworkDescription& d) {
  return architecture_of(d).parameter_shapes(d);
}

std::vector<float> initial_parameters(const NetworkDescription& d, std::uint64_t seed) {
  return architecture_of(d).initial_parameters(d, seed);
}

}  // namespace hqslam::nn
