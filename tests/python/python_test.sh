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
  "$python" -m mypy --strict "$examples"/*.py
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

# Examples with the real packages; each is left out where its package is missing.
for tool in evo open3d rerun; do
  if "$python" -c "import $tool" 2>/dev/null; then
    "$python" "$examples/other_tools/use_$tool.py" drive drive/truth.tum >"$tool.txt"
  else
    echo "$python has no $tool: SKIPPED"
  fi
done
[[ ! -e evo.txt ]] || grep -E '^APE RMSE: evo (0\.0[0-9]+) m, hqslam \1 m$' evo.txt
[[ ! -e open3d.txt ]] || grep 'PointCloud with [1-9][0-9][0-9][0-9][0-9] points' open3d.txt
[[ ! -e rerun.txt ]] || (($(stat -c %s drive.rrd) > 1000000))
if "$python" -c "import evalio.cli" 2>/dev/null; then
  "$python" "$source_folder/tests/python/evalio_dataset.py" drive
  export PYTHONPATH=$source_folder/tests/python EVALIO_CUSTOM=hqslam.evalio,evalio_dataset
  evalio=(env EVALIO_DATA=. "$python" -c 'from evalio.cli import app; app()')
  "${evalio[@]}" run -d simulated/drive -p hqslam -o evalio >/dev/null
  "${evalio[@]}" stats evalio | tee evalio.txt
  grep -qE 'hqslam .* 0\.00[0-9] ' evalio.txt  # ATE, metres
else
  echo "$python has no evalio that starts: SKIPPED"
fi

for example in "$examples"/*.py "$examples"/other_tools/*.py; do
  (($(wc -l <"$example") < 40)) || { echo "$example has 40 lines or more"; exit 1; }
done
