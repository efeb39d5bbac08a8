#!/usr/bin/env bash
# Runs a law at several spacings and horizons and prints how the pulse travelled: bash measure.sh pmb, bash measure.sh lps.
# Another program than ../../build/perilat: PERILAT=path bash measure.sh pmb
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}
law=$1

# Speed from the pulse's centre of gravity in time at both stations. Shape: the far pulse less the near one, moved by what it needs,
# in the mean square, over the near one.
measure() { # table of the histories
  awk -F, -v E=25e9 -v rho=2323 '
    NR == 1 { for (k = 1; k <= NF; k++) { if ($k ~ /^time/) t = k; if ($k ~ /^near/) a = k; if ($k ~ /^far/) b = k }; next }
    { T[++n] = $t; A[n] = $a; B[n] = $b }
    function at(x,   k) { k = int((x - T[1])/(T[2] - T[1])) + 1
      return k < 1 || k >= n ? 0 : A[k] + (A[k + 1] - A[k])*(x - T[k])/(T[k + 1] - T[k]) }
    END {
      for (k = 1; k <= n; k++) { sa += A[k]; ta += A[k]*T[k]; sb += B[k]; tb += B[k]*T[k]; if (B[k] > top) top = B[k] }
      lag = tb/sb - ta/sa; speed = 0.4/lag; theory = sqrt(E/rho)
      for (k = 1; k <= n; k++) { d = B[k] - at(T[k] - lag); num += d*d; den += B[k]^2 }
      printf "%8.1f m/s  %+6.2f %%  peak %+6.2f %%  shape %5.2f %%\n",
        speed, 100*(speed/theory - 1), 100*(top/(1e6/(rho*theory)) - 1), 100*sqrt(num/den) }' "$1"
}

echo "$law: speed, against sqrt(E/rho); peak velocity against stress/(rho c); change of shape over 0.4 m"
for case in "2.5 3.015" "1.25 3.015" "0.625 3.015" "1.25 4.015" "0.625 5.015"; do
  read -r spacing horizon <<<"$case"
  half=$(awk "BEGIN { print $spacing/2 }")
  "$perilat" run "$law.nml" --set "lattice.spacing=$spacing mm" --set "lattice.horizon=$horizon" \
    --set "lattice.origin=$half mm, $half mm" --set "output.result=${law}_${spacing}_$horizon.h5" >"$law.log" 2>&1 || { cat "$law.log"; exit 1; }
  "$perilat" export "${law}_${spacing}_$horizon.h5" -o "${law}.csv" >/dev/null
  printf '%6s mm, horizon %s spacings: ' "$spacing" "$horizon"
  measure "$law.csv"
done
