#!/usr/bin/env bash
# The Python module, its stubs and its examples, where a Python has it (`pip install .`) and
# hqslam-lab makes recordings for it:
#   python_test.sh SOURCE_FOLDER [HQSLAM_LAB_PROGRAM] [PYTHON]
# 77: one of them is missing.
set -euo pipefail
source_folder=$1
laboratory=${2:-}
python=${3:-python3}
export OMP_WAIT_POLICY=passive
if ! "$python" -c 'import hqslam' 2>/dev/null; then
  echo "$python has no module hqslam (pip install $source_folder): SKIPPED"
  exit 77
fi
if [[ ! -x "$laboratory" ]]; then
  echo "there is no hqslam-lab to make recordings with: SKIPPED"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$python" "$source_folder/tests/python/module_test.py" "$laboratory"

examples=$source_folder/examples/python
if "$python" -m mypy --version >/dev/null 2>&1; then
  "$python" -m mypy --strict -p hqslam
  "$python" -m mypy --strict "$examples"
else
  echo "mypy is not there: the types of module and examples were not checked: SKIPPED"
fi

"$laboratory" simulate --drive block --sensor os1-16 --scans 12 --out drive >/dev/null
"$laboratory" simulate --drive block --sensor os1-64 --scans 3 --out all_rows >/dev/null
"$python" "$examples/01_slam_on_a_recording.py" drive drive/truth.tum | tail -1
"$python" "$examples/02_upsample_a_scan.py" all_rows
"$python" "$examples/03_upsample_and_locate.py" drive
"$python" "$examples/04_look_inside_a_layer.py" drive | tail -4
"$python" "$examples/05_train_for_your_sensor.py" all_rows "$laboratory" 2 | tail -1
for example in "$examples"/*.py; do
  (($(wc -l <"$example") < 40)) || { echo "$example has 40 lines or more"; exit 1; }
done
