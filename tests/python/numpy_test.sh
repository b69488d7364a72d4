#!/usr/bin/env bash
# DU-OR in numpy (examples/numpy/du_or.py) gives what the engine gives, within 1 mm and with the same
# pixels rejected, where a Python has numpy:
#   numpy_test.sh SOURCE_FOLDER HQSLAM_LAB_PROGRAM HQSLAM_PROGRAM
# 77: it has not.
set -euo pipefail
source_folder=$1 laboratory=$2 hqslam=$3
if ! python3 -c 'import numpy' 2>/dev/null; then
  echo "python3 has no numpy: SKIPPED"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
weights=$source_folder/weights/du-or_os1_16to64.npz
"$laboratory" simulate --drive town --sensor os1-64 --scans 1 --seed 3 --out "$folder/drive" >/dev/null
"$hqslam" inspect "$folder/drive" --weights "$weights" --npz "$folder/tensors.npz" >/dev/null
python3 "$source_folder/examples/numpy/du_or.py" "$weights" "$folder/tensors.npz" | tee "$folder/out"
python3 "$source_folder/examples/numpy/du_or.py" "$weights" | tee -a "$folder/out"
if python3 -c 'import matplotlib' 2>/dev/null; then
  (cd "$source_folder/examples" && HQS_WEIGHTS=$weights HQS_TENSORS=$folder/tensors.npz \
    python3 "$source_folder/tests/python/notebook.py" hqs.ipynb)
else
  echo "python3 has no matplotlib: the notebook was not run: SKIPPED"
fi
awk '/rejected/ { masks += $NF } { ++lines; if ($NF > worst) worst = $NF }
     END { exit !(lines == 24 && masks == 0 && worst < 1e-3) }' "$folder/out"
