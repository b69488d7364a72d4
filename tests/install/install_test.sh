#!/usr/bin/env bash
# The libraries install alone and are found from another project:
#   install_test.sh BUILD_FOLDER CXX_COMPILER CXX_FLAGS
set -euo pipefail
source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build_folder=$1
compiler=$2
flags=$3 # a library with sanitizers needs them in its user too
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

for component in core nn slam sim; do
  cmake --install "$build_folder" --prefix "$folder/prefix" --component "$component" >/dev/null
done

cmake -S "$source_folder" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -Wno-dev \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" \
  -DCMAKE_PREFIX_PATH="$folder/prefix" >"$folder/log" 2>&1 ||
  { cat "$folder/log"; exit 1; }
cmake --build "$folder/build" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }

# They run: without arguments they say 2.
for consumer in drive_to_poses lift_scans; do
  status=0
  "$folder/build/$consumer" || status=$?
  [[ $status == 2 ]] || { echo "$consumer ended with $status instead of 2"; exit 1; }
done

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
CMAKE
cmake -S "$folder/core_only" -B "$folder/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$folder/prefix" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
echo "hqslam installs and is found"
