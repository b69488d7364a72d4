#!/usr/bin/env bash
# Whether the tests notice when a line is wrong: makes the mutations of mutations.txt one after the
# other in a copy of the sources, builds the test program that should notice, and runs it.
#   tests/mutation/run.sh [PART]     only the mutations whose line holds PART
# The copy is kept in HQSLAM_MUTATION_FOLDER (build/mutation), results.txt in it says what became of
# each. Mutations that are known to survive are argued in survivors.md; exit status 1 if there are
# others.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${HQSLAM_MUTATION_FOLDER:-$root/build/mutation}
source=$folder/source
build=$source/build/release
results=$folder/results.txt
part=${1:-}
jobs=${HQSLAM_MUTATION_JOBS:-$(nproc)}
most_seconds=600

mkdir -p "$source"
(cd "$root" && git ls-files -z | xargs -0 cp -u --remove-destination --parents -t "$source")
cp "$here/mutations.txt" "$folder" # it may be edited meanwhile
cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -Wno-dev \
  -DHQSLAM_WARNINGS_AS_ERRORS=ON -DHQSLAM_BUILD_TOOLS=OFF >/dev/null

build_program() { cmake --build "$build" -j "$jobs" --target "$1" >"$folder/build.log" 2>&1; }
program_of() { find "$build/tests" -name "$1" -type f -executable; }
# Whether the tests of a program pass; with a second argument those of files of that name.
passes() {
  timeout "$most_seconds" "$(program_of "$1")" ${2:+-sf="*$2*"} >"$folder/test.log" 2>&1
}

: >"$results"
note() { echo "$1: $2" | tee -a "$results"; }

while read -r file program tests expression; do
  [[ -z "$file" || "$file" == '#'* ]] && continue
  line="$file $expression"
  [[ "$file $program $tests $expression" == *"$part"* ]] || continue
  cp "$root/$file" "$source/$file"
  sed -i "$expression" "$source/$file"
  changed=$(diff "$root/$file" "$source/$file" | grep -c '^<') || true
  if [[ "$changed" != 1 ]]; then
    note "STALE, changes $changed lines" "$line"
  elif ! build_program "$program"; then
    note "not compiled" "$line"
  elif ! passes "$program" "$tests"; then
    note caught "$line"
  elif ! passes "$program"; then
    note "caught elsewhere" "$line"
  elif grep -qF -- "$expression" "$here/survivors.md"; then
    note "survived, as argued" "$line"
  else
    note SURVIVED "$line"
  fi
  cp "$root/$file" "$source/$file"
done <"$folder/mutations.txt"

echo
cut -d: -f1 "$results" | sort | uniq -c
! grep -qE '^(SURVIVED|STALE)' "$results"
