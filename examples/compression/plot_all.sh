#!/usr/bin/env bash
# Runs what is missing and draws the curves of both profiles, thesis.png and objective.png, and the damage of each
# prism with the particles that have yielded. Another program than ../../build/perilat: PERILAT=path bash plot_all.sh
# Then finite elements beside the lattice: beside.png.
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}

draw() { # ending of the names, picture, title
  local angle
  for angle in 0 15 30; do
    [[ -s rot$angle$1.h5 ]] || "$perilat" run "rot$angle$1.nml"
    "$perilat" plot "rot$angle$1.h5" --map damage --frame 21 --factor 20 --mark yielded -o "rot$angle$1_damage.png"
  done
  "$perilat" plot "rot0$1.h5" "rot15$1.h5" "rot30$1.h5" --x displacement --y load --title "$3" \
    --label "0 degrees" --label "15 degrees" --label "30 degrees" --line "f_c A = 620.6 kN" -o "$2"
}

draw ""         thesis.png    "Prism in compression, law as published"
draw _objective objective.png "Prism in compression, objective profile"
[[ -s rot0_continuum.h5 ]] || "$perilat" run rot0_continuum.nml
"$perilat" plot rot0_continuum.h5 --map D --frame 22 --factor 20 -o rot0_continuum_damage.png
"$perilat" plot rot0.h5 rot0_continuum.h5 --x displacement --y load --title "Prism in compression" \
  --label lattice --label "finite elements, Mazars" --line "f_c A = 620.6 kN" -o beside.png
