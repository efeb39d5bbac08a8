#!/usr/bin/env bash
# Runs what is missing and draws the curves of both profiles, thesis.png and objective.png, and the crack of each
# disc. Another program than ../../build/perilat: PERILAT=path bash plot_all.sh
# Then finite elements beside the lattice: beside.png.
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}

draw() { # ending of the names, picture, title
  local angle
  for angle in 0 15 30; do
    [[ -s rot$angle$1.h5 ]] || "$perilat" run "rot$angle$1.nml"
    "$perilat" plot "rot$angle$1.h5" --map damage --factor 20 --mark yielded -o "rot$angle$1_damage.png"
  done
  "$perilat" plot "rot0$1.h5" "rot15$1.h5" "rot30$1.h5" --x displacement --y load --title "$3" \
    --label "0 degrees" --label "15 degrees" --label "30 degrees" --line "theory = 193 kN" -o "$2"
}

draw ""         thesis.png    "Brazilian disc, law as published"
draw _objective objective.png "Brazilian disc, objective profile"
for deck in rot0_continuum rot0_brittle; do
  [[ -s $deck.h5 ]] || "$perilat" run "$deck.nml"
done
"$perilat" plot rot0_continuum.h5 --map damage_t --factor 20 -o rot0_continuum_damage.png
"$perilat" plot rot0_brittle.h5 --map crack_opening --factor 20 -o rot0_brittle_crack.png
"$perilat" plot rot0.h5 rot0_continuum.h5 rot0_brittle.h5 --x displacement --y load --title "Brazilian disc" \
  --label lattice --label "plastic damage" --label "brittle cracking" --line "theory = 193 kN" -o beside.png
