#pragma once

#include <Python.h>

namespace hqslam::python {

/// While it lives, the other threads of Python go on.
///
/// A daemon thread that asks for Python again while the process ends would be ended by it within
/// C++, which ends the process with an error ("terminate called without an active exception"). So
/// from the first exit handler on such threads sleep here until the process has ended.
class OthersGoOn {
 public:
  OthersGoOn() : thread_(PyEval_SaveThread()) {}
  ~OthersGoOn();
  OthersGoOn(const OthersGoOn&) = delete;
  OthersGoOn& operator=(const OthersGoOn&) = delete;

 private:
  PyThreadState* thread_;
};

/// Of Python's atexit, at which the process begins to end.
void let_others_sleep();

}  // namespace hqslam::python
