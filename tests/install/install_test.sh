#!/usr/bin/env bash
# The libraries install alone and are found from another project:
#   install_test.sh BUILD_FOLDER CXX_COMPILER CXX_FLAGS [HQSLAM_LAB_PROGRAM]
# With the program the projects also run, on a drive that it simulates.
set -euo pipefail
source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build_folder=$1
compiler=$2
flags=$3 # a library with sanitizers needs them in its user too
program=${4:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

for component in core evaluation recordings live nn slam lego_loam; do
  cmake --install "$build_folder" --prefix "$folder/prefix" --component "$component" >/dev/null
done

cmake -S "$source_folder" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -Wno-dev \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" \
  -DCMAKE_PREFIX_PATH="$folder/prefix" >"$folder/log" 2>&1 ||
  { cat "$folder/log"; exit 1; }
cmake --build "$folder/build" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }

# They run: without arguments they say 2.
for consumer in drive_to_poses driver_to_poses upsample_scans; do
  status=0
  "$folder/build/$consumer" || status=$?
  [[ $status == 2 ]] || { echo "$consumer ended with $status instead of 2"; exit 1; }
done

# Where PCL is, its VoxelGrid thins what hqslam reads.
if [[ -x "$folder/build/05_pcl" ]]; then
  printf '%s\n' '1 1 1' '1.1 1.1 1.1' '5 5 5' >"$folder/cloud.txt"
  [[ $("$folder/build/05_pcl" "$folder/cloud.txt" "$folder/thinned.ply" 2) == "2 of 3 points" ]] ||
    { echo "05_pcl does not thin three points to two"; exit 1; }
fi

# They read a recording, upsample and locate: after ten scans as far
# from the start as the truth, to 0.1 m.
if [[ -n "$program" ]]; then
  weights="$source_folder/../../weights/du-mix_os1_16to64.npz"
  "$program" simulate --drive block --sensor os1-16 --scans 24 --out "$folder/drive" >/dev/null 2>&1
  "$folder/build/drive_to_poses" "$folder/drive" "$weights" >"$folder/poses"
  "$folder/build/driver_to_poses" "$folder/drive" "$weights" >"$folder/driver_poses"
  end_of() { awk 'END { print $1, $2, $3, NR }' "$1"; }
  truth=$(awk 'NR == 1 { x = $2; y = $3; z = $4 }
               END { print sqrt(($2-x)^2 + ($3-y)^2 + ($4-z)^2) }' "$folder/drive/truth.tum")
  for poses in "$folder/poses" "$folder/driver_poses"; do
    end_of "$poses" | awk -v truth="$truth" '{
      gap = sqrt($1^2 + $2^2 + $3^2) - truth
      exit !($4 == 24 && truth > 1 && gap < 0.1 && gap > -0.1) }' ||
      { echo "$poses ends at $(end_of "$poses"), $truth m from its start"; exit 1; }
  done
fi

# core alone must be enough where only core was installed.
rm -rf "$folder/prefix" "$folder/build"
cmake --install "$build_folder" --prefix "$folder/prefix" --component core >/dev/null
mkdir "$folder/core_only"
cat >"$folder/core_only/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(core_only LANGUAGES CXX)
find_package(hqslam REQUIRED COMPONENTS core)
find_package(hqslam QUIET COMPONENTS slam)
if(hqslam_FOUND)
  message(FATAL_ERROR "slam was found though it is not installed")
endif()
if(NOT hqslam_NOT_FOUND_MESSAGE MATCHES "no component slam")
  message(FATAL_ERROR "it is not said which component is missing")
endif()
CMAKE
cmake -S "$folder/core_only" -B "$folder/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$folder/prefix" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
echo "hqslam installs and is found"
