#!/usr/bin/env bash
# In bash, Tab offers subcommands, options and sensors: completion_test.sh SOURCE_FOLDER PROGRAMS_FOLDER
set -u
export PATH=$2:$PATH
# shellcheck source=/dev/null
source "$1/tools/completion/hqslam.bash"
offers() {
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _hqslam
  [[ "${COMPREPLY[*]}" == "$expected" ]] ||
    { echo "after '$*' bash offers '${COMPREPLY[*]}', expected '$expected'"; exit 1; }
}
offers "info inspect" hqslam i
offers "--imu" hqslam run --im
offers "os1-64 os1-16" hqslam run drive --sensor os
offers "" hqslam run nothing-of-this-name
