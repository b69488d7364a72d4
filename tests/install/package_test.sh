#!/usr/bin/env bash
# cpack makes a Debian package whose program runs and which says what it needs:
#   package_test.sh BUILD_FOLDER
set -euo pipefail
build_folder=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
if ! command -v dpkg-shlibdeps >/dev/null; then
  echo "dpkg-shlibdeps (dpkg-dev) is not there: SKIPPED"
  exit 0
fi

cpack --config "$build_folder/CPackConfig.cmake" -B "$folder" >"$folder/log" 2>&1 ||
  { cat "$folder/log"; exit 1; }
dpkg-deb -x "$folder"/hqslam_*.deb "$folder/root"
for file in bin/hqslam bin/hqslam-lab share/man/man1/hqslam.1 share/hqslam/weights/du-mix_any-beams.npz \
  share/doc/hqslam/LICENSE include/hqslam/slam/slam.h; do
  [[ -f "$folder/root/usr/$file" ]] || { echo "usr/$file is not in the package"; exit 1; }
done
weights=$(cd "$folder/root/usr/share/hqslam/weights" && echo *.npz)
[[ "$weights" == "du-mix-memory_any-beams.npz du-mix_any-beams.npz" ]] ||
  { echo "the package has the weights $weights"; exit 1; }
depends=$(dpkg-deb -f "$folder"/hqslam_*.deb Depends)
for library in libc6 libembree libgoogle-glog libzip libpcap; do
  [[ "$depends" == *"$library"* ]] || { echo "Depends lacks $library: $depends"; exit 1; }
done
program=$folder/root/usr/bin/hqslam
"$program-lab" simulate --drive block --sensor os1-16 --scans 5 --out "$folder/drive" >/dev/null 2>&1
"$program" run "$folder/drive" --out "$folder/results" >/dev/null 2>&1
[[ $(wc -l <"$folder/results/trajectory.tum") == 5 ]]
