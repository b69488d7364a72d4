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

for component in core recordings nn slam pipeline; do
  cmake --install "$build_folder" --prefix "$folder/prefix" --component "$component" >/dev/null
done
if [[ -d "$build_folder/slam/lego_loam" ]]; then
  cmake --install "$build_folder" --prefix "$folder/prefix" --component lego_loam >/dev/null
fi

cmake -S "$source_folder" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -Wno-dev \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" \
  -DCMAKE_PREFIX_PATH="$folder/prefix" >"$folder/log" 2>&1 ||
  { cat "$folder/log"; exit 1; }
cmake --build "$folder/build" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }

# They run: without arguments their exit status is 2. Each has fewer than 40 lines.
for example in "$source_folder"/../../examples/cpp/*.cpp; do
  (($(wc -l <"$example") < 40)) || { echo "$example has 40 lines or more"; exit 1; }
  consumer=$folder/build/$(basename "$example" .cpp)
  [[ -x "$consumer" ]] || continue  # needs a library that was not built
  status=0
  "$consumer" || status=$?
  [[ $status == 2 ]] || { echo "$consumer ended with $status instead of 2"; exit 1; }
done

# Flags of the caller change neither structures nor results.
if grep -qw avx2 /proc/cpuinfo; then
  "$folder/build/caller_flags" >"$folder/plain"
  for flags in -mavx2 -march=native; do
    "$folder/build/caller_flags${flags//[-=]/_}" | cmp - "$folder/plain" ||
      { echo "a program compiled with $flags gets other results"; exit 1; }
  done
else
  echo "skipped: caller_flags, for this processor has no AVX2"
fi

# Where PCL is, its VoxelGrid thins what hqslam reads.
if [[ -x "$folder/build/05_pcl" ]]; then
  printf '%s\n' '1 1 1' '1.1 1.1 1.1' '5 5 5' >"$folder/cloud.txt"
  [[ $("$folder/build/05_pcl" "$folder/cloud.txt" "$folder/thinned.ply" 2) == "2 of 3 points" ]] ||
    { echo "05_pcl does not thin three points to two"; exit 1; }
fi

# They read a recording, upsample and locate: after 24 scans as far
# from the start as the truth, to 0.1 m.
if [[ -n "$program" ]]; then
  "$program" simulate --drive block --sensor os1-16 --scans 24 --out "$folder/drive" >/dev/null 2>&1
  for example in 01_recording_to_poses 03_driver_callback; do
    "$folder/build/$example" "$folder/drive" >"$folder/poses"
    truth=$(awk 'NR == 1 { x = $2; y = $3; z = $4 }
                 END { print sqrt(($2-x)^2 + ($3-y)^2 + ($4-z)^2) }' "$folder/drive/truth.tum")
    awk -v truth="$truth" 'END {
      gap = sqrt($1^2 + $2^2 + $3^2) - truth
      exit !(NR == 24 && truth > 1 && gap < 0.1 && gap > -0.1) }' "$folder/poses" ||
      { echo "$example ends at $(tail -1 "$folder/poses"), $truth m from its start"; exit 1; }
  done
  "$folder/build/02_upsample_scans" "$source_folder/../../weights/du-mix_any-beams.npz" \
    "$folder/drive/scans.npy" "$folder/upsampled.npy"
  (($(stat -c %s "$folder/upsampled.npy") > 24 * 64 * 1024 * 4)) ||
    { echo "02_upsample_scans wrote fewer than 24 images of 64 rows"; exit 1; }
  weights=$source_folder/../../weights/du-or_os1_16to64.npz
  "$folder/build/04_look_inside_a_layer" "$folder/drive" "$weights" | grep -q '^layers.0.z' ||
    { echo "04_look_inside_a_layer names no layers.0.z"; exit 1; }
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
