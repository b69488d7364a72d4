#include <cstddef>
#include <cstdint>

#include "hqslam/core/error.h"
#include "readers.h"

// HQSLAM_FUZZ_READER is one of the functions of readers.h.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    hqslam::fuzz::HQSLAM_FUZZ_READER({data, size});
  } catch (const hqslam::Error&) {
    return 0;
  }
  return 0;
}
