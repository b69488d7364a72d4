#pragma once

#include <stdexcept>

namespace hqslam {

/// Wrong input: a file, a shape or an option. The message is one line that says what was expected,
/// what was found and how to mend it. Numerical trouble is not an Error but a status in a result.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One scan of a recording that cannot be understood: it is left out, the next one can be asked
/// for.
class ScanError : public Error {
 public:
  using Error::Error;
};

}  // namespace hqslam
