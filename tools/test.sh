#!/usr/bin/env bash
# Installs, builds everything, runs every test and checks the sources.
#   tools/test.sh
#   tools/test.sh --tidy             clang-tidy reads the simulator and the command line too
#   tools/test.sh --fuzz [SECONDS]   and then fuzzes every reader for 20 seconds, or so many
#   tools/test.sh --sanitizers       and then every test under address and undefined-behaviour sanitizers
#   tools/test.sh --thread           and then what uses threads under the thread sanitizer
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=$(nproc)
# Tests run side by side: threads that wait must not spin.
export OMP_WAIT_POLICY=passive

step() { printf '\n== %s\n' "$1"; }

# The project's files with one of these endings: what git tracks, or all there are without git.
sources() {
  if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    git ls-files "$@"
  else
    local pattern
    for pattern in "$@"; do
      find . -path ./build -prune -o -name "$pattern" -type f -print
    done
  fi
}

step "Packages"
tools/setup.sh checks
# The preset light shares nearly all objects with the preset release.
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
  export CCACHE_SLOPPINESS=time_macros,include_file_mtime,include_file_ctime,pch_defines
fi

step "Build"
cmake --preset release -Wno-dev >/dev/null
cmake --build --preset release -j "$jobs"

step "Tests"
ctest --preset release -j "$jobs"

# Who includes whom is a test, and so is what links with a part alone (tests/install).
step "Without PCL and Embree; core alone; core and nn alone"
cmake --preset light -Wno-dev -DHQSLAM_BUILD_TESTS=OFF >/dev/null
cmake --build --preset light -j "$jobs"
cmake --preset core-only -Wno-dev >/dev/null
cmake --preset nn-only -Wno-dev -DCMAKE_BUILD_TYPE= -DHQSLAM_BUILD_TESTS=OFF >/dev/null
cmake --build --preset nn-only -j "$jobs"
for part in EVALUATION RECORDINGS NN NN_COMPARE NN_REFERENCE SLAM LEGO_LOAM LAB; do
  cmake --preset release -B build/without --fresh -Wno-dev "-DHQSLAM_BUILD_$part=OFF" >/dev/null
done

step "Format"
if command -v clang-format >/dev/null; then
  sources '*.cpp' '*.h' | xargs clang-format --dry-run -Werror
  echo "clang-format: no difference"
else
  echo "clang-format is not there: SKIPPED"
fi

step "clang-tidy"
if command -v clang-tidy >/dev/null; then
  # Sources that include Ceres would take minutes to parse. Clang does not find GCC's omp.h,
  # so it reads the sources as without OpenMP: a field that only num_threads() uses looks unused.
  # Read are the sources that the last three days changed: they were read when they came. With --tidy
  # all, the simulator and the command line too: ten minutes of two cores.
  tidied='(core|nn|slam|core/(evaluation|recordings|live)|nn/(compare|reference|training))/src/|nn/(graph|hqs|kernels)/'
  since=$(git rev-list -1 --before='3 days ago' HEAD 2>/dev/null || true)
  if [[ "${1:-}" == --tidy ]]; then tidied='(core|nn|slam|tools)/(.*/)?src/' since=; fi
  cmake --preset release -B build/tidy -Wno-dev -DHQSLAM_PRECOMPILED_HEADERS=OFF \
    -DCMAKE_UNITY_BUILD=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
  if [[ -n "$since" ]]; then
    git diff --name-only --diff-filter=d "$since" -- '*.cpp'
  else
    sources '*.cpp'
  fi | { grep -E "^(\./)?$tidied" || true; } |
    { xargs -r grep -L -E '#include [<"](ceres|omp\.h)' || true; } >build/tidy/files
  xargs -r -P "$jobs" -n 3 clang-tidy --quiet -p build/tidy --extra-arg=-fno-openmp \
    --extra-arg=-Wno-unused-private-field --extra-arg=-Wno-unknown-warning-option \
    <build/tidy/files 2>/dev/null
  echo "clang-tidy: no finding in $(wc -l <build/tidy/files) sources"
else
  echo "clang-tidy is not there: SKIPPED"
fi

if [[ "${1:-}" == --fuzz ]]; then
  step "Fuzzing"
  tools/fuzz.sh "${2:-20}"
fi

if [[ "${1:-}" == --sanitizers ]]; then
  step "Address and undefined-behaviour sanitizers"
  cmake --preset sanitizers -Wno-dev >/dev/null
  cmake --build --preset sanitizers -j "$jobs"
  ctest --preset sanitizers -j "$jobs"
fi

# Clang, whose OpenMP tells the sanitizer what its barriers and locks order; GCC's does not, and each
# of its barriers would look like a race. Debian's libraries are not instrumented.
if [[ "${1:-}" == --thread ]]; then
  step "Thread sanitizer"
  tools/setup.sh fuzz
  threaded=(test_nn test_nn_compare test_slam test_recordings test_accuracy)
  cmake --preset thread -Wno-dev >/dev/null
  cmake --build --preset thread -j "$jobs" --target "${threaded[@]}"
  ctest --preset thread -R "^($(IFS='|' && echo "${threaded[*]}"))$"
fi

step "All passed"
