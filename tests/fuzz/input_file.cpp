#include "input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>

namespace hqslam::fuzz {
namespace {

/// Written over in place: replacing a file costs some file systems milliseconds.
class InputFile {
 public:
  explicit InputFile(const char* extension) {
    const bool memory = std::filesystem::is_directory("/dev/shm");
    path_ = std::string(memory ? "/dev/shm" : "/tmp") + "/hqslam-fuzz-" + std::to_string(getpid()) +
            extension;
    descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
    if (descriptor_ < 0) std::abort();
  }
  ~InputFile() {
    close(descriptor_);
    unlink(path_.c_str());
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& set(Bytes input) const {
    const auto size = static_cast<ssize_t>(input.size());
    if (pwrite(descriptor_, input.data(), input.size(), 0) != size ||
        ftruncate(descriptor_, size) != 0) {
      std::abort();
    }
    return path_;
  }

 private:
  std::string path_;
  int descriptor_ = -1;
};

}  // namespace

std::string as_file(Bytes input, const char* extension) {
  static std::map<std::string, InputFile> files;
  return files.try_emplace(extension, extension).first->second.set(input);
}

}  // namespace hqslam::fuzz
