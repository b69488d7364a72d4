# Completes subcommands, options, sensors and files of hqslam and hqslam-lab in bash; both are asked
# for what they offer, so that this file need not change with them.
_hqslam() {
  local program=${COMP_WORDS[0]} current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  local offered=
  if ((COMP_CWORD == 1)); then
    offered=$("$program" --help 2>/dev/null | sed -n '/^Subcommands:/,$s/^  \([a-z][a-z-]*\) .*/\1/p')
  elif [[ $current == -* ]]; then
    offered=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null | grep -oE '^ +(-h,)?--[a-z-]+' | grep -oE -e '--[a-z-]+')
  elif [[ $before == --sensor ]]; then
    offered=$("$program" info /dev/null --sensor ? 2>&1 | grep -oE 'expected one of .* or a' | grep -oE '[a-z]+[0-9-]+[0-9a-z-]*')
  fi
  mapfile -t COMPREPLY < <(compgen -W "$offered" -- "$current")
  if [[ -z $offered ]]; then compopt -o default 2>/dev/null || true; fi
}
complete -F _hqslam hqslam hqslam-lab
