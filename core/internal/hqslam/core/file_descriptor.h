#pragma once

#include <unistd.h>

#include <utility>

namespace hqslam {

/// Owns a POSIX file descriptor, such as a socket's, and closes it.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  /// Below 0: none, as system calls that fail return it.
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor(FileDescriptor&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~FileDescriptor() {
    if (descriptor_ >= 0) close(descriptor_);
  }

  int get() const { return descriptor_; }
  explicit operator bool() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

}  // namespace hqslam
