#!/usr/bin/env bash
# Installs what is missing, builds both programs, and runs hqslam on a drive that is simulated on the
# spot. Results: hqslam-demo/
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

echo "1/3 packages: tools/setup.sh installs what is missing"
tools/setup.sh
echo "2/3 build: hqslam and hqslam-lab into build/release/bin (minutes, once)"
cmake --preset release -Wno-dev >/dev/null
cmake --build --preset release --target hqslam hqslam-lab -j "$(nproc)"
echo "3/3 demo: a simulated drive, SLAM with 64 beams, with 16, and with 16 upsampled to 64"
# Waiting threads sleep and leave the cores to other programs.
OMP_WAIT_POLICY=passive build/release/bin/hqslam-lab demo --out hqslam-demo
