#!/usr/bin/env bash
# Pages with a view that turns, in a headless Chromium that draws in software: they draw, turn, zoom
# and step through scans, and nothing complains.
#   turning_view_browser_test.sh SOURCE_FOLDER HQSLAM_PROGRAM
# 77: there is no Chromium.
set -euo pipefail
source_folder=$1
program=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [[ -z "$browser" ]]; then
  echo "there is no Chromium (apt-get install chromium): SKIPPED"
  exit 77
fi
export OMP_WAIT_POLICY=passive
folder=$(mktemp -d)
trap 'rm -rf "$folder" || true' EXIT
cd "$folder"

"$program" simulate --drive block --sensor os1-64 --scans 6 --out drive >/dev/null 2>&1
"$program" run drive --rows 16 --upsample linear --dense-map --out results >/dev/null 2>&1
"$program" view results/dense_map.ply results/map.pcd --out map.html >/dev/null

for page in results/report.html map.html; do
  cat "$page" "$source_folder/tests/tools/report/turning_view.html" >tried.html
  : >log
  "$browser" --headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader \
    --enable-unsafe-swiftshader --user-data-dir="$folder/profile" --window-size=1280,1000 \
    --enable-logging=stderr --remote-debugging-port=0 "file://$folder/tried.html#scan=3" >/dev/null 2>log &
  running=$!
  for ((tenths = 0; tenths < 3000; ++tenths)); do
    ! grep -q TRIED log && kill -0 $running 2>/dev/null && sleep 0.1 || break
  done
  kill $running 2>/dev/null && wait $running 2>/dev/null || true
  console=$(grep CONSOLE log || true)
  [[ "$console" == *'"TRIED: all as it should be, '* && $(wc -l <<<"$console") == 1 ]] ||
    { echo "$page:"; echo "${console:-nothing was tried}"; tail -5 log; exit 1; }
  echo "$page: $(grep -o '[0-9]* pictures a second' log)"
done
