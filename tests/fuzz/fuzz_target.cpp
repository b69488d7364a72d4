#include <cstddef>

#include "hqslam/core/error.h"
#include "input_file.h"

namespace hqslam::fuzz {

// The linker (--wrap) has the calls of whole_file come to whole_input: of the time of the cheapest
// readers a third would go into a file that is written and read again.
std::string whole_input(const std::string& path, const std::string& kind,
                        std::size_t max_bytes) asm("__wrap_" HQSLAM_WHOLE_FILE);
std::string real_whole_file(const std::string& path, const std::string& kind,
                            std::size_t max_bytes) asm("__real_" HQSLAM_WHOLE_FILE);

namespace {

constexpr const char* kInMemory = "input";
Bytes g_input;

}  // namespace

std::string as_whole_file(Bytes input, const char* /*extension*/) {
  g_input = input;
  return kInMemory;
}

std::string whole_input(const std::string& path, const std::string& kind, std::size_t max_bytes) {
  if (path != kInMemory) return real_whole_file(path, kind, max_bytes);
  return {g_input.begin(), g_input.end()};
}

}  // namespace hqslam::fuzz

// HQSLAM_FUZZ_READER is one of the functions of readers.h.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    hqslam::fuzz::HQSLAM_FUZZ_READER({data, size});
  } catch (const hqslam::Error&) {  // which the readers are for
  }
  return 0;
}
