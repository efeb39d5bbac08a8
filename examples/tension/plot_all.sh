#!/usr/bin/env bash
# Runs what is missing and draws the curves of all rotations, curves.png, the crack of each, and the quasi-static curve
# beside the dynamic one, quasi_static.png, and that of finite elements beside the lattice's, beside.png. Another program
# than ../../build/perilat: PERILAT=path bash plot_all.sh
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}

for angle in 0 15 30; do
  [[ -s rot$angle.h5 ]] || "$perilat" run "rot$angle.nml"
  "$perilat" plot "rot$angle.h5" --map damage --factor 50 -o "rot${angle}_damage.png"
done
"$perilat" plot rot0.h5 rot15.h5 rot30.h5 --x displacement --y load --title "Prism in tension" \
  --label "0 degrees" --label "15 degrees" --label "30 degrees" --line "f_t A = 58.88 kN" -o curves.png
[[ -s rot0_quasi_static.h5 ]] || "$perilat" run rot0_quasi_static.nml
"$perilat" plot rot0.h5 rot0_quasi_static.h5 --x displacement --y load --label dynamic --label quasi-static \
  -o quasi_static.png
for deck in rot0_continuum rot0_brittle; do
  [[ -s $deck.h5 ]] || "$perilat" run "$deck.nml"
done
"$perilat" plot rot0_continuum.h5 --map D --factor 50 -o rot0_continuum_damage.png
"$perilat" plot rot0_brittle.h5 --map crack_opening --frame 20 --factor 50 -o rot0_brittle_crack.png
"$perilat" plot rot0.h5 rot0_continuum.h5 rot0_brittle.h5 --x displacement --y load --title "Prism in tension" \
  --label lattice --label "finite elements, Mazars" --label "finite elements, brittle cracking" \
  --line "f_t A = 58.88 kN" -o beside.png
