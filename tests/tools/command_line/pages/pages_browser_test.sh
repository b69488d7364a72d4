#!/usr/bin/env bash
# Every page in a headless Chromium that draws in software: none has an error, all answer to the
# pointer and fit a phone; the view of points draws, turns, zooms and steps through scans.
#   pages_browser_test.sh SOURCE_FOLDER HQSLAM [HQSLAM_LAB]
# Without HQSLAM_LAB, which simulates the drive, or without a Chromium: 77.
set -euo pipefail
source_folder=$1
program=$2
laboratory=${3:-}
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [[ -z "$browser" || -z "$laboratory" ]]; then
  echo "there is no Chromium (apt-get install chromium) or no hqslam-lab: SKIPPED"
  exit 77
fi
export OMP_WAIT_POLICY=passive
checks=$source_folder/tests/tools/command_line/pages
folder=$(mktemp -d)
trap 'rm -rf "$folder" || true' EXIT
cd "$folder"

# open URL SIZE: the lines that the page writes to the console, until one begins with TRIED.
open() {
  : >log
  "$browser" --headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader \
    --enable-unsafe-swiftshader --user-data-dir="$folder/profile" --window-size="$2" \
    --enable-logging=stderr --remote-debugging-port=0 "$1" >/dev/null 2>log &
  local running=$!
  for ((tenths = 0; tenths < ${3:-3000}; ++tenths)); do
    ! grep -q TRIED log && kill -0 $running 2>/dev/null && sleep 0.1 || break
  done
  kill $running 2>/dev/null && wait $running 2>/dev/null || true
}
# try PAGE CHECK SIZE: the page with the script of the check at its end.
try() {
  cat "$1" "$checks/$2" >tried.html
  open "file://$PWD/tried.html#scan=4" "$3"
  local console
  console=$(grep CONSOLE log || true)
  [[ "$console" == *'"TRIED: all as it should be, '* && $(wc -l <<<"$console") == 1 ]] ||
    { echo "$1, $2, $3:"; echo "${console:-nothing was tried}"; tail -5 log; exit 1; }
  echo "$1: $(grep -o 'should be, [^"]*' log)"
}

"$laboratory" simulate --drive block --sensor os1-64 --scans 60 --out drive >/dev/null 2>&1
"$program" run drive --rows 16 --upsample linear --dense-map --occupancy-grid --out results >/dev/null 2>&1
"$program" view results/dense_map.ply results/map.pcd results/map.yaml results/trajectory.tum drive/truth.kitti --out view.html >/dev/null
for weights in du-or du-mix simple-du; do
  "$program" inspect drive --weights $weights \
    --tensor layers.0.h --scan 3 --out $weights.html >/dev/null 2>&1
done
"$program" inspect drive --slam --scan 9 --out slam_scan.html >/dev/null 2>&1
"$program" calibrate drive --path 20 --out calibration.json >/dev/null 2>&1
"$laboratory" table --drives drive --methods rows-16,linear,rows-64 --scans 20 --out table >/dev/null 2>&1
# A template of tools/web opens as it is, beside its styles and scripts: here with a demo's data.
cp "$source_folder"/tools/web/*.{css,js} .
data='{"title": "t", "version": "1", "view": {"centre": [0, 0, 0], "radius": 5, "heights": [0, 1],
  "clouds": [], "paths": [], "loops": [], "scans": []}, "table": {"columns": ["", "a"], "rows": [["b", "1"]],
  "links": ["c.html"]}, "notes": ["d"], "max_range_m": 100,
  "images": [{"caption": "e", "rows": 1, "columns": 4, "ranges": [0, 1, 20, 3]}]}'
sed "s|id=\"data\">|&${data//$'\n'/ }|" "$source_folder"/tools/web/demo.html >demo_page.html

for page in results/report.html du-or.html du-mix.html simple-du.html slam_scan.html \
  calibration.html table/table.html demo_page.html view.html; do
  try $page every_page.html 1366,768
  try $page every_page.html 500,844
done
for page in results/report.html view.html; do
  try $page turning_view.html 1280,1000
done

# The page of a sensor that sends nothing yet.
"$program" live --sensor vlp-16 --port 47822 --out live --view 0 >live.out 2>&1 &
live=$!
for ((tenths = 0; tenths < 300; ++tenths)); do
  ! grep -q 'page: http' live.out && sleep 0.1 || break
done
open "$(grep -o 'http://[^ ]*' live.out)" 1366,768 50
kill $live
if grep CONSOLE log; then exit 1; fi
