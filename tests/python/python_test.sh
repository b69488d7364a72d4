#!/usr/bin/env bash
# The Python module, its stubs and its examples, where a Python has it (`pip install .`):
#   python_test.sh SOURCE_FOLDER [PYTHON]
# 77: it has not.
set -euo pipefail
source_folder=$1
python=${2:-python3}
export OMP_WAIT_POLICY=passive
if ! "$python" -c 'import hqslam' 2>/dev/null; then
  echo "$python has no module hqslam (pip install $source_folder): SKIPPED"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$python" "$source_folder/tests/python/module_test.py"

examples=$source_folder/examples/python
if "$python" -m mypy --version >/dev/null 2>&1; then
  "$python" -m mypy --strict -p hqslam
  "$python" -m mypy --strict "$examples"
else
  echo "mypy is not there: the types of module and examples were not checked: SKIPPED"
fi

bin=$(dirname "$("$python" -c 'import sys; print(sys.executable)')")
"$bin/hqslam" simulate --drive block --sensor os1-16 --scans 12 --out drive >/dev/null
"$python" "$examples/01_upsample_a_scan.py"
"$python" "$examples/02_slam_on_a_recording.py" drive os1-16 drive/truth.tum | tail -1
"$python" "$examples/03_look_inside_a_layer.py" | tail -4
"$python" "$examples/04_train_for_your_sensor.py" 2 | tail -1
for example in "$examples"/*.py; do
  (($(wc -l <"$example") < 40)) || { echo "$example has 40 lines or more"; exit 1; }
done
