#!/usr/bin/env bash
# Angle of the crack in results, to the direction of the notch: of the straight line from the middle of the crack at x = 30 mm, behind
# its kink at the notch, to that at the side of the plate. Another program than ../../build/perilat: PERILAT=path bash measure.sh RESULT ...
set -euo pipefail
perilat=${PERILAT:-$(dirname "$0")/../../build/perilat}

for result in "$@"; do
  "$perilat" export "$result" --frame -1 --field broken |
    awk -F, -v result="$result" '
      NR > 1 && $4 > 0.25 {
        k = $2 > 0.029 && $2 < 0.031 && $3 > -0.01 ? 1 : $2 > 0.098 ? 2 : 0
        weight[k] += $4; x[k] += $4 * $2; y[k] += $4 * $3
      }
      END {
        if (!weight[1] || !weight[2]) { print result ": the crack does not cross the plate"; exit 1 }
        dx = x[2] / weight[2] - x[1] / weight[1]
        dy = y[2] / weight[2] - y[1] / weight[1]
        printf "%s: %.1f degrees\n", result, 90 + atan2(dy, dx) * 180 / 3.141592653589793
      }'
done
