#!/usr/bin/env bash
# The angle of the crack with its error bar: on the hexagonal and the square lattice in six directions, and on blue noise of six seeds,
# each at three spacings with one law, horizon and load. Prints a table, and writes it: angles.csv. What has been run is not run again.
# Another program than ../../build/perilat: PERILAT=path bash angles.sh
set -euo pipefail
cd "$(dirname "$0")"
export PERILAT=${PERILAT:-../../build/perilat}

study() { # deck, key that is varied, its values, columns of sites from the notch, in spacings (- if none)
  local s origin=()
  for s in 1 0.75 0.6; do
    local horizon=$(awk "BEGIN { print 3.015 / $s }") step=$(awk "BEGIN { print 0.1 * $s }")
    [[ $4 == - ]] || origin=(--set "lattice.origin=$(awk "BEGIN { print 25 + $4 * $s }") mm, $(awk "BEGIN { print $s / 2 }") mm")
    "$PERILAT" study "$1.nml" --vary "lattice.$2=$3" --y separated -o "angles_$1_$s" --set "lattice.spacing=$s mm" \
      --set "lattice.horizon=$horizon" --set "protect[1].radius=$horizon" --set "protect[2].radius=$horizon" \
      --set "simulation.step=$step us" "${origin[@]}" >"angles_$1_$s.txt"
  done
}

study hexagon    rotation 0..30:6 0.25
study square     rotation 0..45:9 0.5
study blue_noise seed     1..6:1 -

echo "kind, spacing [mm], angle, deviation, least, most" >angles.csv
for kind in hexagon square blue_noise; do
  for s in 1 0.75 0.6; do
    bash measure.sh "angles_${kind}_$s"/*.h5 | awk -v kind=$kind -v s=$s '
      { a = $(NF - 1); n++; sum += a; squares += a * a; if (n == 1 || a < least) least = a; if (a > most) most = a }
      END { mean = sum / n; printf "%s, %s, %.1f, %.1f, %.1f, %.1f\n", kind, s, mean, sqrt((squares - n * mean * mean) / (n - 1)), least, most }'
  done
done >>angles.csv
column -s, -t angles.csv
