#!/usr/bin/env bash
# Every block of docs/cookbook.md that is marked sh works as it stands, one after the other:
#   cookbook_test.sh SOURCE_FOLDER FOLDER_OF_PROGRAMS
set -euo pipefail
export HQSLAM=$1 PATH=$2:$PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
sed -n '/^```sh$/,/^```$/p' "$HQSLAM/docs/cookbook.md" | grep -v '^```' >recipes
if ! python3 -c 'import numpy' 2>/dev/null; then
  echo "python3 has no numpy: its recipe is SKIPPED"
  sed -i '/^python3/d' recipes
fi
while IFS= read -r line; do
  [[ -z "$line" ]] && continue
  echo "\$ $line"
  { eval "$line"; } >out 2>&1 </dev/null || { cat out; echo "failed: $line"; exit 1; }
done <recipes
for file in results/report.html map.html results/map.yaml layers.html slam.html tensors.npz; do
  [[ -s "$file" ]] || { echo "$file was not written"; exit 1; }
done
