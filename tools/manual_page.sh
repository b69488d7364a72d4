#!/usr/bin/env bash
# The manual page, made of what the program itself says: manual_page.sh HQSLAM_PROGRAM >hqslam.1
set -euo pipefail
program=$1

# Text as it is: backslashes doubled, no line taken for a request.
as_it_is() {
  printf '.nf\n'
  sed -e 's/\\/\\\\/g' -e "s/^[.']/\\\\\\&&/" -e 's/-/\\-/g'
  printf '.fi\n'
}

version=$("$program" --version)
summary=$("$program" --help | head -1)
mapfile -t commands < <("$program" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z-]*\) .*/\1/p')

printf '.TH HQSLAM 1 "" "%s" "User commands"\n' "$version"
printf '.SH NAME\nhqslam \\- %s\n' "${summary%.}"
printf '.SH SYNOPSIS\n.B hqslam\nCOMMAND [OPTIONS]\n.SH COMMANDS\n'
"$program" --help | sed -n '/^Subcommands:/,$p' | tail -n +2 | as_it_is
for command in "${commands[@]}"; do
  printf '.SH HQSLAM %s\n' "${command^^}"
  "$program" "$command" --help | as_it_is
done
