#!/usr/bin/env bash
# Installs what hqslam needs to be built on Debian 12; does nothing where all is there. On other
# systems with apt it tries the same packages.
#   tools/setup.sh          to build and run
#   tools/setup.sh light    for the preset light: without PCL and Embree
#   tools/setup.sh checks   also what tools/test.sh checks the sources with
#   tools/setup.sh fuzz     also what tools/fuzz.sh and the thread sanitizer need
#   tools/setup.sh arm64    also what tools/test_arm64.sh needs
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config
  libeigen3-dev libfmt-dev nlohmann-json3-dev libzip-dev            # core
  libpcap-dev libsqlite3-dev liblz4-dev libzstd-dev libbz2-dev      # recordings
  libcpp-httplib-dev                                                # live
  libceres-dev                                                      # slam
  libcli11-dev                                                      # the programs
  doctest-dev                                                       # the tests
)
if [[ "${1:-}" != light ]]; then
  packages+=(libpcl-dev libembree-dev) # LeGO-LOAM; the simulated city
fi
if [[ "${1:-}" == checks ]]; then
  packages+=(clang-format clang-tidy ccache)
elif [[ "${1:-}" == fuzz ]]; then
  packages+=(clang lld libclang-rt-dev libomp-dev)
elif [[ "${1:-}" == arm64 ]]; then
  packages+=(g++-aarch64-linux-gnu qemu-user)
fi

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "setup: not Debian or Ubuntu, nothing installed. Needed are the counterparts of:"
  echo "  ${packages[*]}"
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ "$status" == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "setup: all packages are there"
  exit 0
fi

# shellcheck source=/dev/null
system=$(. /etc/os-release 2>/dev/null && echo "${ID:-} ${VERSION_ID:-}" || true)
if [[ "$system" != "debian 12" ]]; then
  echo "setup: made for Debian 12; here CMake must be 3.25 or newer and Embree (libembree-dev) 3"
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "setup: neither root nor sudo, nothing installed. Missing packages:"
    echo "  ${missing[*]}"
    exit 0
  fi
  as_root=(sudo)
fi

# A container has no use for the manual's index, whose rebuilding can take minutes.
if [[ -e /.dockerenv || -e /run/.containerenv || -n "${container:-}" ]]; then
  "${as_root[@]}" rm -f /var/lib/man-db/auto-update
fi
echo "setup: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
