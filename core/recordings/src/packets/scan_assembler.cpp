#include "hqslam/recordings/scan_assembler.h"

#include <utility>

#include "packets/ouster_decoder.h"
#include "packets/velodyne_decoder.h"

namespace hqslam::recordings {

std::unique_ptr<ScanAssembler> velodyne_assembler(const VelodyneStream& stream,
                                                  const SensorModel& sensor, std::string name,
                                                  const TurnDecoderOptions& options) {
  return std::make_unique<VelodyneDecoder>(stream, sensor, options, std::move(name));
}

std::unique_ptr<ScanAssembler> ouster_assembler(const OusterMetadata& metadata, std::string name,
                                                const OusterOptions& options) {
  return std::make_unique<OusterDecoder>(metadata, options, std::move(name));
}

}  // namespace hqslam::recordings
