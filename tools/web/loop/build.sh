#!/usr/bin/env bash
# Makes a page that computes the loop of eq. 10 itself, from weights of du-or and a scan of all rows
# (the scans.npy of a simulated drive, of which the first is taken); needs Debian's emscripten:
#   tools/web/loop/build.sh WEIGHTS.npz SCANS.npy OUT.html
set -euo pipefail
weights=$(realpath "$1") scans=$(realpath "$2") out=$(realpath "$3")
web=$(dirname "$(dirname "$(realpath "${BASH_SOURCE[0]}")")")
cd "$web/../.."
work=${TMPDIR:-/tmp}/hqslam-loop
mkdir -p "$work/include"
for folder in /usr/include/{nlohmann,fmt} /usr/include/eigen3/{Eigen,unsupported}; do
  ln -sfn "$folder" "$work/include/"
done

mapfile -t sources < <(ls nn/{src,kernels,graph,hqs}/*.cpp core/src/sensor/*.cpp |
  grep -vE '/(weights_file|upsampler|upsampled_cloud)\.cpp$')
sources+=(core/src/files/{json_fields,excerpt,nearest_names}.cpp core/src/scan/organized_cloud.cpp
  tools/hqslam/inspect/what_if.cpp tools/web/loop/engine.cpp)
flags=(-std=c++20 -O3 -DNDEBUG -msimd128 -fwasm-exceptions -ffp-contract=off -Wno-unknown-pragmas
  -DFMT_HEADER_ONLY -DHQSLAM_KERNELS=kPortableKernels -isystem "$work/include"
  -Itools/web/loop/gaps -include tools/web/loop/gaps/library.h
  -Icore/include -Icore/internal -Icore/src -Inn -Inn/src -Inn/include -Itools/hqslam)
printf '%s\0' "${sources[@]}" | xargs -0 -P "$(nproc)" -I{} bash -c '
  object=$1/$(tr / _ <<<"$2").o
  [[ $object -nt $2 ]] || em++ "${@:3}" -c "$2" -o "$object"' - "$work" {} "${flags[@]}"
em++ -O1 -fwasm-exceptions "$work"/*.o -o "$work/engine.js" -s SINGLE_FILE=1 -s MODULARIZE=1 \
  -s EXPORT_NAME=hqslamEngine -s ALLOW_MEMORY_GROWTH=1 -s ENVIRONMENT=web \
  -s EXPORTED_RUNTIME_METHODS=ccall \
  -s EXPORTED_FUNCTIONS=_parameter_names,_set_parameters,_change_network,_upsample,_result_ranges,_tensor,_malloc,_free

# Styles, scripts and data into the page.
{
  printf '{"title": "Equation 10, live", "version": "%s", "subtitle": "%s", "weights": "' \
    "$(sed -n 's/^project(hqslam VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)" "$(basename "$weights")"
  base64 -w0 "$weights"
  printf '", "scan": "'
  base64 -w0 "$scans"
  printf '"}'
} >"$work/data.json"
while IFS= read -r line; do
  case $line in
    *'href="base.css"'*) echo '<style>' && cat "$web/base.css" && echo '</style>' ;;
    *'id="data"'*) echo '<script type="application/json" id="data">' && cat "$work/data.json" && echo '</script>' ;;
    *'<script src="'*)
      file=${line#*src=\"} file=${file%%\"*}
      echo '<script>' && cat "$(ls "$work/$file" "$web/$file" "$web/loop/$file" 2>/dev/null | head -1)" && echo '</script>' ;;
    *) printf '%s\n' "$line" ;;
  esac
done <tools/web/loop/loop.html >"$out"
echo "$out: $(($(wc -c <"$out") / 1024)) kB"
