#!/usr/bin/env bash
# Gives hostile inputs to every reader, SECONDS each, under address and undefined-behaviour
# sanitizers; ends with an error at the first finding.
#   tools/fuzz.sh [SECONDS]                 20 by default
#   tools/fuzz.sh SECONDS READER...         only these; tests/fuzz/readers.h names them
#   tools/fuzz.sh --inputs COUNT READER...  COUNT inputs for each reader instead of a time
# build/fuzz/corpus keeps inputs that reach new code, for the next run; build/fuzz/findings has the
# findings.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [[ "${1:-}" == --inputs ]]; then
  limit=-runs=$2
  readers=("${@:3}")
else
  limit=-max_total_time=${1:-20}
  readers=("${@:2}")
fi

tools/setup.sh fuzz
cmake --preset fuzz -Wno-dev >/dev/null
cmake --build --preset fuzz -j "${HQSLAM_FUZZ_JOBS:-$(nproc)}"

fuzz=build/fuzz/tests/fuzz
"$fuzz/hqslam_fuzz_seeds" build/fuzz/seeds tests/golden
mkdir -p build/fuzz/findings
if ((${#readers[@]} == 0)); then
  for program in "$fuzz"/hqslam_fuzz_*; do
    [[ -x "$program" && -f "$program" && "$program" != *_seeds ]] &&
      readers+=("${program##*/hqslam_fuzz_}")
  done
fi

dictionary_of() {
  case "$1" in
    *json | weights | checkpoint) echo json ;;
    npy | npz | saved_map) echo arrays ;;
    pcap | db3 | mcap | ros1_bag | *packets) echo recordings ;;
    *) echo points ;;
  esac
}

# Bytes. Small files reach nearly all that large ones do; a packet of a Velodyne has 1206.
largest_of() {
  case "$1" in
    pcap | *packets) echo 16384 ;;
    db3) echo 8192 ;;
    *) echo 4096 ;;
  esac
}

# Freed memory is kept for 1 MB of frees, which the cache holds, not 256; allocations are told by two
# callers.
export ASAN_OPTIONS=quarantine_size_mb=1:malloc_context_size=2
# No single allocation over 512 MB: a reader checks a size before it allocates it.
for reader in "${readers[@]}"; do
  mkdir -p "build/fuzz/corpus/$reader"
  log="build/fuzz/$reader.log"
  if ! "$fuzz/hqslam_fuzz_$reader" "build/fuzz/corpus/$reader" "build/fuzz/seeds/$reader" \
    -dict="tests/fuzz/dictionaries/$(dictionary_of "$reader").dict" "$limit" \
    -max_len="$(largest_of "$reader")" -timeout=20 -rss_limit_mb=3000 -malloc_limit_mb=512 \
    -entropic=0 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/findings/$reader-" >"$log" 2>&1; then
    grep -v '^#' "$log" | tail -40
    echo "fuzz: $reader: a finding in build/fuzz/findings, $log tells more"
    exit 1
  fi
  printf '%-18s %10s inputs, %5s features, no finding\n' "$reader" \
    "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" \
    "$(sed -n 's/.* ft: \([0-9]*\) .*/\1/p' "$log" | tail -1)"
done
