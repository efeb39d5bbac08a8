#!/usr/bin/env bash
# Speed and path of the crack in pmb.h5, as `perilat run pmb.nml` writes it: bash measure.sh
# Another program than ../../build/perilat: PERILAT=path bash measure.sh
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}

# Rayleigh's speed of the plane, c_R/c_s = (0.862 + 1.14 nu)/(1 + nu), Poisson's ratio 1/3
"$perilat" export pmb.h5 -o crack.csv >/dev/null
awk -F, -v E=72e9 -v rho=2440 -v nu=0.333333 '
  NR == 1 { for (k = 1; k <= NF; k++) if ($k ~ /^b[0-9]/) { column[++n] = k; place[n] = substr($k, 2, 2) }; next }
  { for (k = 1; k <= n; k++) if (!(k in passed) && $column[k] > 0.2) passed[k] = $1 }
  END {
    rayleigh = (0.862 + 1.14*nu)/(1 + nu)*sqrt(E/(2*(1 + nu)*rho))
    for (k = 1; k <= n; k++) printf "%d mm: %5.1f us\n", place[k], 1e6*passed[k]
    speed = (place[n] - place[2])/1e3/(passed[n] - passed[2])
    printf "from %d to %d mm: %.0f m/s, %.2f of the Rayleigh speed %.0f m/s\n", place[2], place[n], speed, speed/rayleigh, rayleigh
  }' crack.csv

# A straight crack leaves the first row 61 % of its bonds, the second 79 %, the third 96 %.
"$perilat" export pmb.h5 --frame 6 -o crack.csv >/dev/null
awk -F, '
  NR == 1 { for (k = 1; k <= NF; k++) if ($k ~ /^broken/) b = k; next }
  { y = $3 < 0 ? -$3 : $3; if ($b > 0.3 && y > far) far = y }
  END { printf "more than 0.3 of the bonds broken: up to %.2f mm from the plane of the notch\n", 1e3*far }' crack.csv
