#!/usr/bin/env bash
# Cross-compiles core, recordings, nn and slam for 64-bit ARM on a Debian of another architecture and
# runs their tests under qemu.
#   tools/test_arm64.sh                 builds and tests
#   tools/test_arm64.sh CTEST_OPTION... only some, say -R test_nn; with -R test_slam all of slam's
# The arm64 libraries are unpacked into build/arm64-root, by an apt with a state of its own:
# of this machine's packages only a compiler and qemu are added.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=${HQSLAM_ARM64_JOBS:-$(nproc)}
# A test's threads share the host's cores with the other tests'.
export OMP_WAIT_POLICY=passive

packages=(
  libc6-dev libstdc++6 libgomp1
  libeigen3-dev libfmt-dev nlohmann-json3-dev libzip-dev            # core
  libpcap-dev libsqlite3-dev liblz4-dev libzstd-dev libbz2-dev      # recordings
  libcpp-httplib-dev                                                # live
  libceres-dev libblas-dev liblapack-dev                            # slam
  doctest-dev
)

root=$PWD/build/arm64-root
state=$PWD/build/arm64-packages
wanted="${packages[*]}"

# apt as it would be on an arm64 machine on which nothing is installed.
arm64_apt() {
  apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State="$state" \
    -o Dir::State::status="$state/status" -o Dir::Cache="$state/cache" \
    -o APT::Sandbox::User=root -o Debug::NoLocking=1 "$@"
}

fetch() {
  local archives=$state/cache/archives package
  mkdir -p "$state/lists/partial" "$archives/partial"
  : >"$state/status"
  arm64_apt update
  arm64_apt install -y --no-install-recommends --download-only "${packages[@]}"
  rm -rf "$root"
  mkdir -p "$root"
  for package in "$archives"/*.deb; do
    # Compilers and interpreters that run on arm64.
    [[ ${package##*/} =~ ^(gcc|g\+\+|cpp|gfortran|perl|binutils|dpkg)- ]] && continue
    dpkg-deb -x "$package" "$root"
  done
  # What update-alternatives would link.
  (cd "$root/usr/lib/aarch64-linux-gnu" && ln -s blas/libblas.so* lapack/liblapack.so* .)
  # Ceres names the libraries that it was built with by their full paths.
  find "$root/usr/lib" -iname '*targets*.cmake' -exec \
    sed -i "s,\([;\"]\)\(/usr/lib/aarch64-linux-gnu/lib\),\1$root\2,g" {} +
  echo "$wanted" >"$root/unpacked"
}

tools/setup.sh arm64
if [[ "$(cat "$root/unpacked" 2>/dev/null)" != "$wanted" ]]; then
  fetch
fi
cmake --preset arm64 -Wno-dev >/dev/null
cmake --build --preset arm64 -j "$jobs"
if (($# > 0)); then
  exec ctest --preset arm64 -j "$jobs" "$@"
fi
ctest --preset arm64 -j "$jobs" -E '^test_slam$'

# Three quarters of the time of slam's tests go into these eleven drives: a second and more each where
# they are not emulated, minutes where they are.
drives=(
  "a drive around a yard is tracked to centimetres*"
  "a drive is tracked to centimetres whatever the clock does"
  "a drive that drifts by metres is closed*"
  "a place that looks exactly like one passed before*"
  "a sensor that is carried to another place*"
  "a sensor that is carried along the street*"
  "a way that drifts by metres is closed*"
  "a way without drift is left exactly as it is*"
  "empty*nearly empty and garbage scans*"
  "laps without loop closing*"
  "who is carried to a place*"
)
qemu-aarch64 -L "$root" build/arm64/tests/slam/test_slam \
  -tce="$(IFS=,; echo "${drives[*]}")"
