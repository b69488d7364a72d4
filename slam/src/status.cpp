#include "hqslam/slam/status.h"

namespace hqslam::slam {

std::string_view name(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kTooFewFeatures:
      return "too few features";
    case Status::kDegenerate:
      return "degenerate";
    case Status::kNotConverged:
      return "not converged";
    case Status::kAfterGap:
      return "after a gap";
    case Status::kNotRecognized:
      return "not recognized";
  }
  return "unknown";
}

bool is_registered(Status status) {
  return status != Status::kTooFewFeatures && status != Status::kNotRecognized;
}

}  // namespace hqslam::slam
