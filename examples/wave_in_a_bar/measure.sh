#!/usr/bin/env bash
# Runs a law at several spacings and prints how the pulse travelled: bash measure.sh pmb, bash measure.sh lps.
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
    function near(x) { while (k < n && T[k + 1] < x) k++
      return x < T[1] || k >= n ? 0 : A[k] + (A[k + 1] - A[k])*(x - T[k])/(T[k + 1] - T[k]) }
    END {
      for (q = 2; q <= n; q++) {
        dt = T[q] - T[q - 1]; sa += A[q]*dt; ta += A[q]*T[q]*dt; sb += B[q]*dt; tb += B[q]*T[q]*dt
        if (B[q] > top) top = B[q] }
      lag = tb/sb - ta/sa; speed = 0.4/lag; theory = sqrt(E/rho)
      k = 1
      for (q = 1; q <= n; q++) { d = B[q] - near(T[q] - lag); num += d*d; den += B[q]^2 }
      printf "%8.1f m/s  %+6.2f %%  peak %+6.2f %%  shape %5.2f %%\n",
        speed, 100*(speed/theory - 1), 100*(top/(1e6/(rho*theory)) - 1), 100*sqrt(num/den) }' "$1"
}

echo "$law: speed, against sqrt(E/rho); peak velocity against stress/(rho c); change of shape over 0.4 m"
for spacing in 2.5 1.25 0.625; do
  half=$(awk "BEGIN { print $spacing/2 }")
  "$perilat" run "$law.nml" --set "lattice.spacing=$spacing mm" \
    --set "lattice.origin=$half mm, $half mm" --set "output.result=${law}_$spacing.h5" >"$law.log" 2>&1 || { cat "$law.log"; exit 1; }
  "$perilat" export "${law}_$spacing.h5" -o "${law}.csv" >/dev/null
  printf '%6s mm: ' "$spacing"
  measure "$law.csv"
done
