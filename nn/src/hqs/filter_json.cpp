#include "filter_json.h"

#include <cmath>
#include <numbers>

namespace hqslam::nn {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

}  // namespace

void read_filter(JsonFields& fields, const char* field, OutlierRemovalOptions& filter) {
  if (!fields.has(field)) return;
  JsonFields options = fields.object(field);
  double min_angle_deg = filter.min_angle_rad * kDegrees;
  options.optional("min_angle_deg", min_angle_deg);
  filter.min_angle_rad = min_angle_deg / kDegrees;
  options.optional("min_pixels", filter.min_pixels);
  options.optional("support_share", filter.support_share);
  options.finish();
}

nlohmann::ordered_json filter_json(const OutlierRemovalOptions& filter) {
  return {{"min_angle_deg", std::round(filter.min_angle_rad * kDegrees * 1e9) / 1e9},
          {"min_pixels", filter.min_pixels},
          {"support_share", std::round(filter.support_share * 1e6) / 1e6}};
}

}  // namespace hqslam::nn
