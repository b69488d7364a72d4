#pragma once

#include "tools/program/program.h"

// Short runs of every command that writes, for tests of what goes wrong with them.

namespace hqslam::test {

/// As short as does: most of these tests run every command several times.
inline constexpr int kShortDriveScans = 4;
inline const std::string& short_drive() {
  return simulated_drive("--sensor os1-16 --scans " + std::to_string(kShortDriveScans));
}

inline std::string simulate_arguments(const std::string& out, int scans = 3) {
  return fmt::format("simulate --drive block --sensor os1-16 --scans {} --out '{}'", scans, out);
}

inline std::string upsample_arguments(const std::string& out) {
  return fmt::format("upsample '{}' --method linear --sensor os1-64 --bin --out '{}'",
                     short_drive() + "/pcd", out);
}

inline std::string run_arguments(const std::string& out) {
  return fmt::format("run '{}' --out '{}'", short_drive(), out);
}

/// Trains for this many steps; the recipe and the drives are in `folder`.
inline std::string train_arguments(const TemporaryDirectory& folder, const std::string& out,
                                   int steps = 3) {
  write_file(folder.file("recipe.json"), fmt::format(R"({{
    "network": {{"kind": "du-or", "layers": 1, "sensor": "os1-64", "measured_rows": 16,
                 "denoiser": {{"channels": [4, 4], "memory": 1}}}},
    "training": [{{"drive": "block", "seeds": [5], "scans": 2}}],
    "validation": [{{"drive": "block", "seeds": [6], "scans": 1}}],
    "steps": {}, "batch": 1, "augmentation": {{"crop_columns": 64}}, "validate_every": 2
  }})",
                                                     steps));
  return fmt::format("train --config '{0}/recipe.json' --out '{1}' --drives '{0}/drives'",
                     folder.path(), out);
}

}  // namespace hqslam::test
