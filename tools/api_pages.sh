#!/usr/bin/env bash
# Pages of all public headers, in build/api_pages/html/index.html. Any warning of Doxygen's ends it.
#   tools/api_pages.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if ! command -v doxygen >/dev/null; then
  echo "api_pages: doxygen is not there: apt-get install doxygen"
  exit 2
fi
mkdir -p build
mapfile -t headers < <(find . -path ./build -prune -o -type d -name include -print | sort)
doxygen - <<SETTINGS
@INCLUDE = docs/Doxyfile
INPUT = docs/architecture.md ${headers[*]}
STRIP_FROM_INC_PATH = ${headers[*]}
OUTPUT_DIRECTORY = build/api_pages
PROJECT_NUMBER = $(sed -n 's/^project(hqslam VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
SETTINGS
echo "build/api_pages/html/index.html"
