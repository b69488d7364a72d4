#!/usr/bin/env bash
# Whether the Debian package is enough on a bare Debian 12: makes it of build/release, installs it by
# apt in a system of debootstrap's, runs the program there, and builds and runs tests/install against
# its libraries with the packages that it suggests. Needs root, debootstrap and Debian's mirror.
#   tools/test_package.sh [FOLDER]   the bare system is made there, and taken away at the end
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=$(realpath -m "${1:-build/package}")
root=$folder/root

if ((EUID != 0)) || ! command -v debootstrap >/dev/null; then
  echo "test_package: needs root and debootstrap"
  exit 2
fi
if [[ -e "$root" ]]; then
  echo "test_package: $root is there already; name another folder"
  exit 2
fi

cmake --preset release -Wno-dev >/dev/null
cmake --build --preset release -j "${HQSLAM_PACKAGE_JOBS:-$(nproc)}"
mkdir -p "$folder"
rm -f "$folder"/hqslam_*.deb
cpack --config build/release/CPackConfig.cmake -B "$folder" >/dev/null

mounted=()
clean_up() {
  local place
  for place in "${mounted[@]}"; do umount "$place"; done
  rm -rf --one-file-system "$root"
}
trap clean_up EXIT
debootstrap --variant=minbase bookworm "$root" >"$folder/debootstrap.log"
mount -t proc proc "$root/proc" && mounted+=("$root/proc")
cp "$folder"/hqslam_*.deb "$root/root"
mkdir "$root/root/hqslam"
cp -r examples tests "$root/root/hqslam"

inside() {
  chroot "$root" env -i HOME=/root LC_ALL=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin \
    DEBIAN_FRONTEND=noninteractive DEBCONF_NOWARNINGS=yes bash -euo pipefail -c "cd && $1"
}
install_packages() {
  inside "apt-get install -y -qq --no-install-recommends -o Dpkg::Use-Pty=0 $1 >/dev/null"
}
step() { printf '\n== %s\n' "$1"; }

step "Installing, on a system without anything else"
inside "apt-get update -qq"
install_packages "./hqslam_*.deb"
inside "hqslam --version && test -s /usr/share/man/man1/hqslam.1"

step "simulate, upsample, run"
inside "
  weights=/usr/share/hqslam/weights/du-mix_any-beams.npz
  hqslam-lab simulate --drive block --sensor os1-16 --scans 24 --out drive
  hqslam upsample drive --weights \$weights --out upsampled
  hqslam run drive --upsample \$weights --out results
  test \$(wc -l <results/trajectory.tum) = 24"

step "A program of one's own with the installed libraries"
install_packages "g++ cmake ninja-build pkg-config \$(dpkg-query -W -f '\${Suggests}' hqslam | tr -d ,)"
inside "
  cmake -S hqslam/tests/install -B consumer-build -G Ninja -DCMAKE_BUILD_TYPE=Release -Wno-dev >/dev/null
  cmake --build consumer-build
  consumer-build/01_recording_to_poses drive | tail -1"

step "The package is enough"
