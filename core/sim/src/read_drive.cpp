#include "hqslam/sim/read_drive.h"

#include "hqslam/core/json_fields.h"
#include "hqslam/core/whole_file.h"
#include "spec_numbers.h"

namespace hqslam::sim {

namespace {

constexpr std::size_t kMostBytes = 1U << 16U;

}  // namespace

DriveSpec read_drive_json(const std::string& path) {
  JsonFields fields(whole_file(path, "a drive.json written by hqslam simulate", kMostBytes), path,
                    "give a folder written by hqslam simulate, by this version of it");
  DriveSpec spec;
  spec.name = fields.text("name");
  spec.seed = fields.unsigned_integer("seed");
  spec.scans = fields.integer("scans");
  for_each_number(spec, [&](const char* part, const char* name, double& value, double /*low*/,
                            double /*high*/) {
    if (fields.has(part)) value = fields.object(part).number(name);
  });
  validate(spec);
  return spec;
}

}  // namespace hqslam::sim
