#!/usr/bin/env bash
# Installs, builds, and runs hqslam on a drive simulated on the spot. Results: hqslam-demo/
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
cmake --preset release -Wno-dev >/dev/null
cmake --build --preset release --target hqslam -j "$(nproc)"
# Threads that wait leave the cores to whatever else runs.
OMP_WAIT_POLICY=passive build/release/bin/hqslam-lab demo --out hqslam-demo
