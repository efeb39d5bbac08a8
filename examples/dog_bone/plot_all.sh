#!/usr/bin/env bash
# Runs what is missing and draws the curves of B at all spacings, b_curves.png, that of D, d_curve.png, and the crack of
# each. Another program than ../../build/perilat: PERILAT=path bash plot_all.sh
# Then finite elements beside the lattice: b_beside.png, d_beside.png.
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}

for bone in b_s8 b_s4 b_s2 d_s8; do
  [[ -s $bone.h5 ]] || "$perilat" run "$bone.nml"
  "$perilat" plot "$bone.h5" --map damage --frame 14 --factor 50 -o "${bone}_damage.png"
done
"$perilat" plot b_s8.h5 b_s4.h5 b_s2.h5 --x displacement --y load --title "Dog-bone B" \
  --label "8 mm" --label "4 mm" --label "2 mm" -o b_curves.png
"$perilat" plot d_s8.h5 --x displacement --y load --title "Dog-bone D, 8 mm" -o d_curve.png
[[ -s d_graded.h5 ]] || "$perilat" run d_graded.nml
"$perilat" plot d_graded.h5 --map damage --frame 14 --factor 50 -o d_graded_damage.png

beside() { # size, lattice, theory
  local law
  for law in continuum brittle; do
    [[ -s $1_$law.h5 ]] || "$perilat" run "$1_$law.nml"
  done
  "$perilat" plot "$1_continuum.h5" --map damage_t --factor 50 -o "$1_continuum_damage.png"
  "$perilat" plot "$1_brittle.h5" --map crack_opening --frame 20 --factor 50 -o "$1_brittle_crack.png"
  "$perilat" plot "$2.h5" "$1_continuum.h5" "$1_brittle.h5" --x displacement --y load --title "Dog-bone ${1^}" \
    --label lattice --label "plastic damage" --label "brittle cracking" --line "f_t A = $3 kN" -o "$1_beside.png"
}

beside b b_s4 14.49
beside d d_s8 57.96
