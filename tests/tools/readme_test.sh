#!/usr/bin/env bash
# What README.md says is true: its commands run as they stand, its C++ examples are those that
# are compiled.
#   readme_test.sh SOURCE_FOLDER HQSLAM_PROGRAM
set -euo pipefail
readme=$1/README.md
program=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# block LANGUAGE: the lines of all fenced blocks of that language.
block() { awk -v fence='```'"$1" '/^```/ { inside = ($0 == fence); next } inside' "$readme"; }

block cpp >examples
cat "$1/tests/install/drive_to_poses.cpp" "$1/tests/install/driver_callback.h" | diff examples - ||
  { echo "README.md: the C++ examples are not those of tests/install"; exit 1; }

# The recordings that the README takes for granted, under the names that it uses.
hqslam() { "$program" "$@"; }
quietly() { "$@" >log 2>&1 || { echo "failed: $*"; cat log; exit 1; }; }
quietly hqslam simulate --drive block --sensor hdl-64e --scans 4 --bin --out kitti
quietly hqslam simulate --drive block --sensor os1-64 --scans 4 --pcd --out ouster
quietly hqslam simulate --drive block --sensor os1-16 --scans 4 --out ouster16
mv ouster16/scans.npy ranges16.npy
mkdir velodyne_points
mv kitti/bin velodyne_points/data
mv ouster/pcd clouds
mv ouster/scans.npy ranges.npy
mv ouster/sensor.json my_sensor.json
mv ouster/truth.kitti truth.txt
ln -s "$1/weights" weights
cat >my_recipe.json <<'JSON'
{
  "network": {"kind": "du-or", "layers": 1, "sensor": "os1-64", "measured_rows": 16,
              "denoiser": {"channels": [8, 8], "memory": 0}},
  "training": [{"stack": "ranges.npy"}],
  "validation": [{"drive": "block", "seeds": [7], "scans": 1}],
  "steps": 2, "augmentation": {"crop_columns": 64}
}
JSON

# bench, demo and table take long and have tests of their own.
block sh | grep '^hqslam ' | grep -v -E '^hqslam (bench|demo|table)' >commands
(($(wc -l <commands) >= 5)) || { echo "README.md: found only $(wc -l <commands) commands"; exit 1; }
while read -r command; do
  echo "$command"
  eval "quietly $command"
done <commands
