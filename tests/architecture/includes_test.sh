#!/usr/bin/env bash
# Who includes whom: docs/architecture.md's arrows point one way.
#   includes_test.sh SOURCE_FOLDER
set -euo pipefail
cd "$1"
wrong=0

# The lines of a part's sources that include something with this prefix that it may not know.
#   only FOLDER PREFIX ALLOWED...
only() {
  local folder=$1 prefix=$2 found
  shift 2
  local allowed
  allowed=$(IFS='|' && echo "$*")
  found=$(grep -rnE "^#include [<\"]$prefix" "$folder" --include='*.h' --include='*.cpp' |
    grep -vE "#include [<\"]$prefix($allowed)/" || true)
  if [[ -n "$found" ]]; then
    printf '%s may include only %s of %s:\n%s\n' "$folder" "$*" "$prefix" "$found"
    wrong=1
  fi
}

for folder in core/include core/internal core/src; do only $folder hqslam/ core; done
only core/evaluation hqslam/ core evaluation
only tools/lab/simulator hqslam/ core sim
for folder in core/recordings/include core/recordings/src; do only $folder hqslam/ core recordings; done
only core/recordings/live hqslam/ core recordings live
only nn hqslam/ core nn
only slam/src hqslam/ core slam
only slam/include hqslam/ core slam
only slam/lego_loam hqslam/ core slam lego_loam
only tools/pipeline hqslam/ core recordings nn slam lego_loam pipeline
only tools/command_line hqslam/ core evaluation recordings nn slam pipeline
only tools/hqslam hqslam/ core evaluation recordings live nn slam pipeline
only tools/python hqslam/ core evaluation nn recordings slam pipeline

# Within nn: kernels include neither graphs nor networks, graphs no networks, and what upsamples
# nothing that trains.
training='[a-z_]*backward|hqslam/nn/training|trainable'
for pair in kernels:"graph/|hqs/|$training" graph:"hqs/|$training" hqs:"$training" src:"$training" include:"$training"; do
  found=$(grep -rnE "^#include \"([a-z]*/)?(${pair#*:})" "nn/${pair%%:*}" || true)
  if [[ -n "$found" ]]; then
    printf 'nn/%s may not include %s:\n%s\n' "${pair%%:*}" "${pair#*:}" "$found"
    wrong=1
  fi
done

# Heavy parents stay with those who need them, and out of every installed header.
#   stays_in HEADER PATTERN: files of the sources that include <HEADER/ must match.
stays_in() {
  local users
  users=$(grep -rlE "#include [<\"]$1/" --include='*.h' --include='*.cpp' core nn slam tools |
    grep -vE "^($2)" || true)
  if [[ -n "$users" ]]; then
    printf 'only %s may include %s:\n%s\n' "$2" "$1" "$users"
    wrong=1
  fi
}
stays_in ceres 'slam/(lego_loam/)?src/.*\.cpp$'
stays_in embree3 'tools/lab/simulator/src/'
stays_in pcl 'slam/lego_loam/src/|slam/lego_loam/include/hqslam/pcl\.h$'
exit $wrong
