#!/usr/bin/env bash
# The inertial data of a raw KITTI drive for hqslam run --imu, in the LiDAR's frame, without the
# lever arm of 0.8 m.
#   tools/kitti_imu.sh DRIVE [CALIB_IMU_TO_VELO.txt] >imu.csv
set -euo pipefail
drive=$1
calibration=${2:-$drive/../calib_imu_to_velo.txt}
paste -d' ' "$drive/oxts/timestamps.txt" <(cat "$drive"/oxts/data/*.txt) |
  TZ=UTC awk -v R="$(sed -n 's/^R: //p' "$calibration")" 'BEGIN { split(R, r, " ") }
    { split($1, d, "-"); split($2, t, ":")
      stamp = mktime(d[1] " " d[2] " " d[3] " " t[1] " " t[2] " 0") + t[3]
      if (stamp <= last) next
      printf "%.6f", last = stamp
      for (v = 20; v >= 14; v -= 6) for (i = 0; i < 9; i += 3)
        printf ",%.6f", r[i + 1] * $v + r[i + 2] * $(v + 1) + r[i + 3] * $(v + 2)
      print "" }'
