#!/usr/bin/env bash
# What the documents say is true: README.md and docs/*.md. Commands in blocks marked sh run as they
# stand, document by document; examples in C++ and Python are parts of files that are compiled or
# run. Links of all documents lead somewhere.
#   readme_test.sh SOURCE_FOLDER HQSLAM_PROGRAM HQSLAM_LAB_PROGRAM
set -euo pipefail
source_folder=$1
program=$2
laboratory=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
documents=("$source_folder"/README.md "$source_folder"/docs/*.md)

# blocks LANGUAGE DOCUMENT: the lines of its fenced blocks of that language, a form feed after each
# block.
blocks() {
  awk -v fence='```'"$1" '/^```/ { if (inside) printf "\f\n"; inside = ($0 == fence); next } inside' \
    "$2"
}

# are_parts_of LANGUAGE FILE...: the documents' examples in that language.
are_parts_of() {
  local language=$1 examples document block
  shift
  examples=$(cat "$@")
  for document in "${documents[@]}"; do
    while IFS= read -r -d $'\f' block; do
      block=${block#$'\n'}
      [[ "$examples" == *"${block%$'\n'}"* ]] ||
        { echo "$document: an example in $language is no part of those that run:"; echo "$block"; exit 1; }
    done < <(blocks "$language" "$document")
  done
}
are_parts_of cpp "$source_folder"/examples/cpp/*.cpp
are_parts_of python "$source_folder"/examples/python/*.py

# anchors DOCUMENT: what its headings are called in links.
anchors() {
  sed -n 's/^##* //p' "$1" | tr '[:upper:]' '[:lower:]' | sed "s/[^a-z0-9 _-]//g; s/ /-/g"
}

while IFS= read -r document; do
  while read -r link; do
    target=${link%%#*}
    target=${target:+$(dirname "$document")/$target}
    target=${target:-$document}
    [[ -e "$target" ]] || { echo "$document: there is no $link"; exit 1; }
    [[ "$link" != *'#'* ]] || anchors "$target" | grep -qxF -- "${link#*#}" ||
      { echo "$document: nothing is called $link"; exit 1; }
  done < <(awk '/^```/ { inside = !inside } !inside' "$document" | grep -o ']([^)]*)' | sed 's/^](//; s/)$//' | grep -v '^https\?:')
done < <(find "$source_folder" \( -name build -o -name .git -o -name third_party_notices \) -prune \
  -o -name '*.md' -print)

# The recordings that the documents take for granted, under the names that they use.
hqslam() { "$program" "$@"; }
hqslam-lab() { "$laboratory" "$@"; }
# Fails with what a command says on stderr; its stdout goes where the line sends it.
quietly() { "$@" 2>log || { echo "failed: $*" >&2; cat log >&2; exit 1; }; }
quietly hqslam-lab simulate --drive block --sensor hdl-64e --scans 3 --bin --out kitti >stdout
quietly hqslam-lab simulate --drive block --sensor os1-64 --scans 3 --pcd --out ouster >stdout
quietly hqslam-lab simulate --drive block --sensor os1-16 --scans 3 --out ouster16 >stdout
mv ouster16/scans.npy ranges16.npy
mkdir velodyne_points
mv kitti/bin velodyne_points/data
mv ouster/pcd clouds
mv ouster/scans.npy ranges.npy
mv ouster/sensor.json my_sensor.json
mv ouster/truth.kitti truth.txt
ln -s "$source_folder/weights" weights
cat >my_recipe.json <<'JSON'
{
  "network": {"kind": "du-or", "layers": 1, "sensor": "os1-64", "measured_rows": 16,
              "denoiser": {"channels": [8, 8], "memory": 0}},
  "training": [{"stack": "ranges.npy"}],
  "validation": [{"drive": "block", "seeds": [7], "scans": 1}],
  "steps": 2, "augmentation": {"crop_columns": 64}
}
JSON

commands=0
for document in "${documents[@]}"; do
  while read -r command; do
    echo "$command"
    eval "quietly $command" >stdout
    commands=$((commands + 1))
  done < <(blocks sh "$document" | grep -E '^hqslam(-lab)? ')
done
((commands >= 20)) || { echo "found only $commands commands"; exit 1; }
