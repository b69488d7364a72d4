#!/usr/bin/env bash
# Whatever names a version names the one of CMakeLists.txt, from which program and wheel have theirs:
#   version_test.sh SOURCE_FOLDER
set -euo pipefail
cd "$1"
version=$(sed -n 's/^project(hqslam VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
named() { # FILE PATTERN: what the first line that fits has in its group
  local found
  found=$(sed -n "s/$2/\\1/p" "$1" | head -1)
  [[ -n $version && $found == "$version" ]] && return
  echo "$1: version '$found', expected '$version' as in CMakeLists.txt"
  exit 1
}
named CHANGELOG.md '^## \([0-9.]*\).*'
named CITATION.cff '^version: \(.*\)'
