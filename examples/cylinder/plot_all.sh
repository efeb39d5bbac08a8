#!/usr/bin/env bash
# Runs what is missing and draws the curves of all rotations, curves.png, and the crack of each. Another program than
# ../../build/perilat: PERILAT=path bash plot_all.sh
# Then finite elements beside the lattice: beside.png.
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}

for angle in 0 15 30; do
  [[ -s rot$angle.h5 ]] || "$perilat" run "rot$angle.nml"
  "$perilat" plot "rot$angle.h5" --map damage --frame 20 --factor 100 -o "rot${angle}_damage.png"
done
"$perilat" plot rot0.h5 rot15.h5 rot30.h5 --x displacement --y load --title "Split cylinder" \
  --label "0 degrees" --label "15 degrees" --label "30 degrees" --line "theory = 236 kN" \
  --band "laboratory = 204 kN, 236 kN" -o curves.png
for deck in rot0_continuum rot0_brittle; do
  [[ -s $deck.h5 ]] || "$perilat" run "$deck.nml"
done
"$perilat" plot rot0_continuum.h5 --map damage_t --factor 20 -o rot0_continuum_damage.png
"$perilat" plot rot0_brittle.h5 --map crack_opening --factor 20 -o rot0_brittle_crack.png
"$perilat" plot rot0.h5 rot0_continuum.h5 rot0_brittle.h5 --x displacement --y load --title "Split cylinder" \
  --label lattice --label "plastic damage" --label "brittle cracking" --line "theory = 236 kN" -o beside.png
